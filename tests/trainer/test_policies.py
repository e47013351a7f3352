"""mart.policies, the trainer's door for other people's code."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import mart.policies
from mart.policies import (
    ACTION_SIZE,
    TrainingProgress,
    TrainingSpec,
    evaluate_policy,
    load_policy,
    train_policy,
)
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import get_task
from tests.trainer.conftest import Recorded

_WITHOUT_TORCH = """
import sys
from pathlib import Path
sys.modules["torch"] = None  # what an import finds where it is not installed
from mart.policies import TrainingSpec, load_policy, train_policy
from mart.protocol.errors import Unavailable
for call in (
    lambda: load_policy(Path("checkpoint")),
    lambda: train_policy(TrainingSpec(model="BC", data=(Path("episodes"),)), Path("run")),
):
    try:
        call()
    except Unavailable as error:
        print(str(error).count("."), str(error))
"""


@pytest.fixture
def spec(episodes: Recorded) -> TrainingSpec:
    return TrainingSpec(model="d-BC", data=(episodes.root,), seeds=(0, 4), preset="debug")


def test_everything_public_is_there_and_says_what_it_is() -> None:
    for name in set(mart.policies.__all__) - {"ACTION_SIZE"}:
        assert getattr(mart.policies, name).__doc__, name


def test_what_is_trained_can_be_loaded_and_acts(spec: TrainingSpec, tmp_path: Path) -> None:
    told: list[TrainingProgress] = []
    checkpoints = train_policy(spec, tmp_path, told.append)
    assert [path.name for path in checkpoints] == ["seed-0", "seed-4"]
    assert (told[-1].updates, told[-1].updates_in_all) == (20, 20)
    assert train_policy(spec, tmp_path) == checkpoints  # nothing was left to do
    policy = load_policy(checkpoints[1])
    shapes = {o.name: o.shape for o in get_task(policy.task).observations}
    policy.begin(worlds=3, seed=0)
    actions = policy.act({name: np.zeros((3, *shapes[name])) for name in policy.needs})
    assert actions.shape == (3, len(policy.arms), ACTION_SIZE)


def test_asked_to_stop_there_is_no_checkpoint_yet(spec: TrainingSpec, tmp_path: Path) -> None:
    stop = threading.Event()
    stop.set()
    assert train_policy(spec, tmp_path, stop=stop) == ()


def test_without_torch_it_imports_and_says_so_in_a_sentence() -> None:
    command = [sys.executable, "-c", _WITHOUT_TORCH]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(said) == 2
    assert all(line.startswith("1 PyTorch is not installed") for line in said)


def test_what_cannot_be_is_refused(spec: TrainingSpec, tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        load_policy(tmp_path / "nowhere")
    with pytest.raises(NotFound):
        train_policy(spec.model_copy(update={"data": (tmp_path / "nowhere",)}), tmp_path / "run")
    policy = load_policy(train_policy(spec, tmp_path / "d-BC")[0])
    with pytest.raises(InvalidInput):
        evaluate_policy(policy.only("arm0"), seeds=(1,))
