"""Policies at run time: what every point of the grid keeps to, and what a bad checkpoint says."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest
import torch

from mart.protocol.errors import Corrupt, InvalidInput, NotFound, Unavailable
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.models.architecture import PAPER, ModelSpec
from mart.trainer.models.checkpoint import RECORD, WEIGHTS
from mart.trainer.models.policies.load import load_policy
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.trainer import recorded
from tests.trainer.conftest import Recorded

LAYOUT = ObservationLayout.of_arms(recorded.TASK, 2)
CHUNKED = ["d-Flow", "rd-Flow", "MIP", "d-Diffusion", "ACT", "none/per-arm/per-arm/act"]
MODELS = [*PAPER, "BC", "BC-RNN-GMM", "d-BC-RNN-GMM", *CHUNKED, "per-arm/joint/per-arm/mlp/gmm"]
SEPARABLE = {
    name
    for name in MODELS
    for model in [ModelSpec.parse(name)]
    if "joint" not in {model.planner, model.actor, model.residual}
}


@pytest.fixture(scope="module")
def checkpoints(episodes: Recorded, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    found = {}
    for model in MODELS:
        root = tmp_path_factory.mktemp("run")
        request = TrainingSpec(
            model=model, data=(episodes.root,), preset="debug", changes={"updates": 3, "residual_updates": 2}
        )
        train(request, root, threading.Event(), lambda _: None)
        run = RunDirectory(root)
        found[model] = run.checkpoint(run.checkpointed()[-1], 0)
    return found


def observations(worlds: int, seed: int = 0) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    return {seen.name: random.normal(size=(worlds, *seen.shape)) * 0.1 for seen in LAYOUT.fields}


@pytest.mark.parametrize("model", MODELS)
def test_it_acts_within_bounds_and_the_same_for_the_same_seed(
    checkpoints: dict[str, Path], model: str
) -> None:
    policy = load_policy(checkpoints[model])
    assert (policy.task, policy.control_hz, policy.arms) == (recorded.TASK, 20.0, ("arm0", "arm1"))

    def course(worlds: int, seed: int) -> np.ndarray:
        policy.begin(worlds, seed)
        seen = [observations(5, t) for t in range(12)]
        return np.array([policy.act({n: v[:worlds] for n, v in one.items()}) for one in seen])

    actions = course(5, 1)
    assert actions.shape == (12, 5, 2, 7)
    assert np.abs(actions).max() <= 1
    np.testing.assert_array_equal(course(5, 1), actions)
    np.testing.assert_allclose(course(2, 1), actions[:, :2], atol=1e-5)


@pytest.mark.parametrize("model", MODELS)
def test_one_arm_alone_acts_as_it_does_among_all_or_says_why_not(
    checkpoints: dict[str, Path], model: str
) -> None:
    policy = load_policy(checkpoints[model])
    with pytest.raises(NotFound):
        policy.only("arm9")
    if model not in SEPARABLE:
        with pytest.raises(InvalidInput):
            policy.only("arm1")
        return
    alone = policy.only("arm1")
    assert alone.arms == ("arm1",)
    assert set(alone.needs) == set(LAYOUT.names_of("arm1"))
    both = load_policy(checkpoints[model])
    for one in (alone, both):
        one.begin(3, 9)
    for t in range(12):
        seen = observations(3, t)
        own = {name: seen[name] for name in alone.needs}
        np.testing.assert_allclose(alone.act(own)[:, 0], both.act(seen)[:, 1], atol=1e-6)


def test_a_subgoal_lasts_a_window_and_memory_begins_anew(checkpoints: dict[str, Path]) -> None:
    """Seeing the same at every tick, a recurrent actor repeats itself with every window; a new subgoal changes that."""
    policy = load_policy(checkpoints["HBC"])
    policy.begin(1, 4)
    seen = observations(1)
    actions = np.array([policy.act(seen)[0].ravel() for _ in range(20)])
    same_goal = load_policy(checkpoints["BC-RNN"])
    same_goal.begin(1, 4)
    recurrent = np.array([same_goal.act(seen)[0].ravel() for _ in range(20)])
    np.testing.assert_array_equal(recurrent[:10], recurrent[10:])
    assert not np.array_equal(recurrent[0], recurrent[1])
    assert not np.array_equal(actions[:10], actions[10:])


def test_bad_observations_are_named(checkpoints: dict[str, Path]) -> None:
    policy = load_policy(checkpoints["d-HBC"])
    policy.begin(2, 0)
    with pytest.raises(InvalidInput):
        policy.act(observations(3))
    with pytest.raises(InvalidInput):
        policy.act({n: v for n, v in observations(2).items() if n != "arm0/gripper"})
    alone = policy.only("arm0")
    alone.begin(2, 0)
    with pytest.raises(InvalidInput):
        alone.act({})
    with pytest.raises(InvalidInput):
        policy.begin(0, 0)


def _damaged(checkpoint: Path, folder: Path) -> Path:
    for name in (RECORD, WEIGHTS):
        (folder / name).write_bytes((checkpoint / name).read_bytes())
    return folder


def test_a_bad_checkpoint_says_what_is_wrong(checkpoints: dict[str, Path], tmp_path: Path) -> None:
    folder = _damaged(checkpoints["HBC"], tmp_path)
    record = (folder / RECORD).read_text()
    cases = {
        record.replace('"format": 1', '"format": 99'): "of format 99; this version reads 1",
        record.replace(recorded.TASK, "two_arm_juggling"): "There is no task 'two_arm_juggling'",
        record.replace("arm0/gripper", "arm0/thumb"): "other observations",
        record.replace('"actor": "joint"', '"actor": "per-arm"'): "weights that are not those",
        record[:100]: "cannot be read",
    }
    for text, words in cases.items():
        (folder / RECORD).write_text(text)
        with pytest.raises(Corrupt, match=words):
            load_policy(folder)
    (folder / RECORD).write_text(record)
    weights = (folder / WEIGHTS).read_bytes()
    (folder / WEIGHTS).write_bytes(weights[: len(weights) // 2])
    with pytest.raises(Corrupt):
        load_policy(folder)
    with pytest.raises(NotFound):
        load_policy(tmp_path / "nowhere")


def test_a_device_that_is_not_there(checkpoints: dict[str, Path]) -> None:
    number = torch.cuda.device_count() + 5
    with pytest.raises(Unavailable):
        load_policy(checkpoints["HBC"], f"cuda:{number}")
    with pytest.raises(InvalidInput):
        load_policy(checkpoints["HBC"], "tpu")
