"""Every point of the grid: shapes, gradients, and who sees what."""

from __future__ import annotations

import itertools

import pytest
import torch

from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.windows import WindowBatch
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.hierarchical_bc import HierarchicalBC
from mart.trainer.models.networks import Networks, window_spec
from mart.trainer.models.rng import UpdateRng, WorldRng
from mart.trainer.train.presets import PRESETS

CPU = torch.device("cpu")
LAYOUT = ObservationLayout.of_arms("three_arm_lift_wiping", 3)  # its arms see different amounts
ARMS = len(LAYOUT.arms)
SIZES = PRESETS["debug"].model_copy(update={"window": 4})
SPANS = ("none", "joint", "per-arm")
GRID = [
    ModelSpec.parse(f"{planner}/{actor}/{residual}/{network}/{head}")
    for planner, actor, residual in itertools.product(SPANS, SPANS[1:], SPANS)
    for network, head in (("rnn", "l2"), ("mlp", "gmm"))
]
HIERARCHIES = list(GRID)
CHUNKED = [
    ModelSpec.parse(f"none/{actor}/{residual}/{network}")
    for actor, residual in (
        ("joint", "none"),
        ("per-arm", "joint"),
        ("joint", "per-arm"),
        ("per-arm", "per-arm"),
    )
    for network in ("flow", "mip", "diffusion", "act")
]
GRID += CHUNKED


def batch_of(model: ModelSpec, seeds: int, windows: int = 5, seed: int = 0) -> WindowBatch:
    generator, spec = torch.Generator().manual_seed(seed), window_spec(model, SIZES)
    return WindowBatch(
        obs=torch.randn(seeds, len(spec.obs), windows, LAYOUT.width, generator=generator),
        goal=torch.randn(seeds, windows, LAYOUT.width, generator=generator),
        actions=torch.rand(seeds, len(spec.actions), windows, ARMS, 7, generator=generator) * 2 - 1,
        weights=None,
    )


def _point(model: ModelSpec) -> str:
    return model.point


@pytest.mark.parametrize("model", GRID, ids=_point)
def test_every_weight_of_the_base_gets_a_gradient(model: ModelSpec) -> None:
    networks = Networks(model, LAYOUT, SIZES, [1, 2])
    losses = networks.model.base_losses(batch_of(model, 2), UpdateRng([1, 2], 0, CPU))
    losses.total.backward()
    for name, weight in networks.named_parameters():
        if not name.startswith("model.residual."):
            assert weight.grad is not None, name
            assert torch.isfinite(weight.grad).all(), name
            assert (weight.grad.flatten(1).abs().sum(1) > 0).all(), name


@pytest.mark.parametrize("model", [m for m in GRID if m.residual != "none"], ids=_point)
def test_the_residual_learns_alone(model: ModelSpec) -> None:
    networks = Networks(model, LAYOUT, SIZES, [1, 2])
    losses = networks.model.residual_losses(batch_of(model, 2), UpdateRng([1, 2], 0, CPU))
    losses.total.backward()
    moved = {name for name, w in networks.named_parameters() if w.grad is not None and w.grad.abs().sum() > 0}
    assert moved
    assert all(name.startswith("model.residual.") for name in moved)
    assert (losses.diagnostics["correction"] == 0).all()


@pytest.mark.parametrize(("subgoal", "is_told"), [("posterior", False), ("prior", False), ("true", True)])
def test_a_residual_learns_on_the_subgoal_that_is_asked_for(subgoal: str, is_told: bool) -> None:
    model = ModelSpec.parse("r-HBC")
    nets = Networks(model, LAYOUT, SIZES.model_copy(update={"residual_subgoal": subgoal}), [1]).model
    assert isinstance(nets, HierarchicalBC)
    batch = batch_of(model, 1)
    error = nets.residual_losses(batch, UpdateRng([1], 0, CPU)).diagnostics["base"].item()
    goal = nets.partition.of(batch.goal)[:, None].expand(-1, batch.obs.shape[1], -1, -1)
    inputs = torch.cat((nets.partition.of(batch.obs), goal), -1)
    told = nets.actor.loss(inputs, nets.partition.split(batch.actions)).mean().item()
    assert (error == pytest.approx(told, rel=1e-5)) == is_told


@pytest.mark.parametrize("model", GRID, ids=_point)
def test_stacked_or_alone_losses_and_gradients_are_the_same(model: ModelSpec) -> None:
    seeds, together = [3, 5, 8], batch_of(model, 3)
    stacked = Networks(model, LAYOUT, SIZES, seeds)
    stacked.model.base_losses(together, UpdateRng(seeds, 7, CPU)).total.backward()
    for i, seed in enumerate(seeds):
        alone = Networks(model, LAYOUT, SIZES, [seed])
        own = WindowBatch(
            together.obs[i : i + 1], together.goal[i : i + 1], together.actions[i : i + 1], None
        )
        alone.model.base_losses(own, UpdateRng([seed], 7, CPU)).total.backward()
        theirs = dict(stacked.named_parameters())
        for name, weight in alone.named_parameters():
            assert torch.equal(weight, theirs[name].chunk(3)[i]), name
            other = theirs[name].grad
            if weight.grad is not None:
                assert other is not None
                torch.testing.assert_close(weight.grad, other.chunk(3)[i], atol=1e-6, rtol=1e-4)


@pytest.mark.parametrize("model", HIERARCHIES, ids=_point)
def test_an_arm_of_a_decentral_model_does_not_see_what_it_should_not(model: ModelSpec) -> None:
    """What arm 0 does depends on what only others see just where something joint is in the model."""
    nets = Networks(model, LAYOUT, SIZES, [1]).model
    assert isinstance(nets, HierarchicalBC)
    if nets.residual is not None:
        torch.nn.init.normal_(nets.residual.net.last.weight)
    foreign = sorted(set(range(LAYOUT.width)) - set(LAYOUT.columns_of("arm0").tolist()))
    obs = torch.randn(1, 3, LAYOUT.width)
    other = obs.clone()
    other[..., foreign] += 1.0
    done = []
    for view in (obs, other):
        noise = WorldRng(0, 3, CPU)
        done.append(nets.act(view, nets.plan(view, noise), nets.start(3), noise)[0])
    same = torch.equal(done[0][:, :, 0], done[1][:, :, 0])
    assert same == ("joint" not in {model.planner, model.actor, model.residual})
    assert done[0].shape == (1, 3, ARMS, 7)


@pytest.mark.parametrize("model", [m for m in HIERARCHIES if m.residual != "none"], ids=_point)
def test_epsilon_bounds_every_arms_correction_and_zero_is_the_base(model: ModelSpec) -> None:
    obs = torch.randn(1, 6, LAYOUT.width)

    def act(point: ModelSpec, epsilon: float) -> torch.Tensor:
        sizes = SIZES.model_copy(update={"residual_epsilon": epsilon})
        nets = Networks(point, LAYOUT, sizes, [4]).model
        assert isinstance(nets, HierarchicalBC)
        if nets.residual is not None:
            generator = torch.Generator().manual_seed(0)
            torch.nn.init.normal_(nets.residual.net.last.weight, std=3.0, generator=generator)
        noise = WorldRng(1, 6, CPU)
        return nets.act(obs, nets.plan(obs, noise), nets.start(6), noise)[0]

    base = act(model.model_copy(update={"residual": "none"}), 0.2)
    assert torch.equal(act(model, 0.0), base)
    length = (act(model, 0.05) - base).norm(dim=-1)
    assert (length < 0.05 + 1e-6).all()
    assert (length > 0).all()


def test_weights_of_ticks_count_by_arm() -> None:
    """A tick with weight 0 moves neither its arm's actor nor, where all arms have it, its planner."""
    model = ModelSpec.parse("per-arm/per-arm/none")
    plain = batch_of(model, 1)
    weights = torch.ones(*plain.actions.shape[:-1])
    weights[..., 0] = 0
    nets = Networks(model, LAYOUT, SIZES, [1])
    batch = WindowBatch(plain.obs, plain.goal, plain.actions, weights)
    nets.model.base_losses(batch, UpdateRng([1], 0, CPU)).total.backward()
    for name, weight in nets.named_parameters():
        if weight.grad is not None:
            assert (weight.grad.flatten(1).abs().sum(1) > 0).tolist() == [False, True, True], name
