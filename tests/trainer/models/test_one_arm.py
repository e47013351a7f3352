"""Windows for one arm alone: what it sees stays, what it does not see is hidden, and only its part counts."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.hyperparameters import Hiding
from mart.trainer.models.networks import Networks
from mart.trainer.models.one_arm import OneArmWindows, for_one_arm, seen_by_arm
from mart.trainer.models.rng import UpdateRng
from tests.trainer.models.test_hierarchical_bc import ARMS, CPU, LAYOUT, SIZES, batch_of

HBC = ModelSpec.parse("HBC")
HIDINGS: tuple[Hiding, ...] = get_args(Hiding)
SEEN = seen_by_arm(LAYOUT)

hidings, shares = st.sampled_from(HIDINGS), st.floats(0.01, 1.0)
seeds = st.lists(st.integers(0, 2**31 - 1), min_size=1, max_size=3, unique=True)


def windows_of(of: list[int], share: float, hiding: Hiding, data_seed: int = 0) -> OneArmWindows:
    batch = batch_of(HBC, len(of), 32, data_seed)
    return for_one_arm(batch.obs, batch.goal, SEEN, UpdateRng(of, 3, CPU), share=share, hiding=hiding)


@given(seeds, shares, hidings)
@settings(max_examples=30)
def test_what_is_told_is_as_recorded_and_the_rest_is_not(of: list[int], share: float, hiding: Hiding) -> None:
    plain, found = batch_of(HBC, len(of), 32), windows_of(of, share, hiding)
    assert torch.equal(found.goal == plain.goal, found.told)
    assert torch.equal(found.obs == plain.obs, found.told[:, None].expand_as(found.obs))


@given(seeds, shares, hidings)
@settings(max_examples=30)
def test_one_arm_counts_for_all_and_is_told_all_that_it_sees(
    of: list[int], share: float, hiding: Hiding
) -> None:
    found = windows_of(of, share, hiding)
    assert (found.counted.sum(-1) == ARMS).all()
    together = (found.counted == 1).all(-1)
    assert found.told[together].all()
    arm = found.counted[~together].argmax(-1)
    assert torch.equal(found.told[~together], SEEN[arm])
    if share == 1:
        assert not together.any()


@given(seeds, shares, hidings)
@settings(max_examples=20)
def test_a_seeds_windows_do_not_depend_on_its_company(of: list[int], share: float, hiding: Hiding) -> None:
    batch, together = batch_of(HBC, len(of), 32), windows_of(of, share, hiding)
    for i, seed in enumerate(of):
        alone = for_one_arm(
            batch.obs[[i]], batch.goal[[i]], SEEN, UpdateRng([seed], 3, CPU), share=share, hiding=hiding
        )
        assert torch.equal(alone.obs[0], together.obs[i])
        assert torch.equal(alone.goal[0], together.goal[i])
        assert torch.equal(alone.counted[0], together.counted[i])


@given(st.integers(0, 2**31 - 1))
@settings(max_examples=20)
def test_what_is_swapped_is_one_other_window_of_the_batch(seed: int) -> None:
    plain, found = batch_of(HBC, 1, 32), windows_of([seed], 1.0, "swap")
    for window in range(32):
        hidden = ~found.told[0, window]
        goal_of = (plain.goal[0][:, hidden] == found.goal[0, window, hidden]).all(-1)
        obs_of = (plain.obs[0][:, :, hidden] == found.obs[0, :, window, hidden][:, None]).all(-1).all(0)
        assert torch.equal(goal_of, obs_of)
        assert goal_of.sum() == 1
        assert not goal_of[window]


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_its_share_of_the_windows_is_for_one_arm_and_all_arms_get_as_many(share: float) -> None:
    batch = batch_of(HBC, 1, 3000)
    counted = for_one_arm(
        batch.obs, batch.goal, SEEN, UpdateRng([0], 0, CPU), share=share, hiding="drop"
    ).counted
    assert (counted == ARMS).any(-1).float().mean() == pytest.approx(share, abs=0.03)
    assert counted.mean((0, 1)).tolist() == pytest.approx([1.0] * ARMS, abs=0.1)


@pytest.mark.parametrize("model", ["HBC", "BC-RNN", "dh-HBC", "dl-HBC"])
@pytest.mark.parametrize("hiding", HIDINGS)
def test_what_the_others_did_does_not_matter_to_one_arm(model: str, hiding: Hiding) -> None:
    """Were every window for arm 0, no weight would learn anything from the others' actions."""
    sizes = SIZES.model_copy(update={"one_arm_share": 1.0, "one_arm_hides": hiding})
    networks, batch = Networks(ModelSpec.parse(model), LAYOUT, sizes, [1]), batch_of(HBC, 1)
    counted = for_one_arm(
        batch.obs, batch.goal, SEEN, UpdateRng([1], 0, CPU), share=1.0, hiding=hiding
    ).counted
    others = batch.actions + (counted == 0)[:, None, :, :, None]
    losses = [
        networks.model.base_losses(replace(batch, actions=actions), UpdateRng([1], 0, CPU)).total
        for actions in (batch.actions, others, batch.actions + 1)
    ]
    assert losses[0] == losses[1]
    assert losses[0] != losses[2]


def test_with_no_share_nothing_is_drawn_for_it() -> None:
    """A training that does not ask for it is what it was, bit for bit."""
    networks, batch = Networks(HBC, LAYOUT, SIZES, [1]), batch_of(HBC, 1)
    drawn, plan = UpdateRng([1], 0, CPU), UpdateRng([1], 0, CPU)
    networks.model.base_losses(batch, drawn)
    plan.normal(1, batch.obs.shape[2], SIZES.vae_latent)
    assert torch.equal(drawn.uniform(1, 4), plan.uniform(1, 4))
