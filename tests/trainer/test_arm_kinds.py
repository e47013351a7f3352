"""What is learned from other arms than Pandas says so, and is not mixed with what is learned from those."""

from __future__ import annotations

import json
import threading
from pathlib import Path

import pytest

from mart.episodes.reader import open_episode
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import get_task
from mart.recorder.export_cli import export
from mart.sim.world import World
from mart.trainer.data.data_spec import Selection
from mart.trainer.data.dataset import load_dataset
from mart.trainer.evaluate.rollouts import common_task
from mart.trainer.serve.policy_seats import require_fit
from mart.trainer.train.progress import TrainingProgress
from mart.trainer.train.spec import TrainingSpec
from mart.trainer.train.training import train
from tests.trainer import recorded
from tests.trainer.serve.toys import Wanderer

KINDS = ("panda", "ur5e")
WIPING = "three_arm_lift_wiping"


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an episode of a Panda and a UR5e."""
    folder, world = tmp_path_factory.mktemp("mixed"), World.build(recorded.TASK, kinds=KINDS)
    recorded.write(folder, world, recorded.perform(world, seed=1)[:20])
    return folder


def test_an_episode_says_its_arms_and_has_as_many_joints_as_they_have(mixed: Path) -> None:
    (path,) = mixed.rglob("*.mcap")
    file = open_episode(path)
    assert file.episode.arm_kinds == file.room.arm_kinds == KINDS
    data = file.arrays()
    assert data.observations["arm0/joint_positions"].shape[1] == 7
    assert data.observations["arm1/joint_positions"].shape[1] == 6


def test_a_data_set_knows_its_arms_and_refuses_to_mix_them(mixed: Path, tmp_path: Path) -> None:
    learned = load_dataset([mixed], Selection())
    assert learned.digest.arm_kinds == KINDS
    field = next(one for one in learned.layout.fields if one.name == "arm1/joint_positions")
    assert field.shape == (6,)
    pandas = World.build(recorded.TASK)
    recorded.write(tmp_path, pandas, recorded.perform(pandas, seed=1)[:20])
    assert load_dataset([tmp_path], Selection()).digest.arm_kinds == ()
    words = (
        r"several kinds of arms \(arm_kinds\) were given: panda and panda, panda and ur5e; one model learns"
    )
    with pytest.raises(InvalidInput, match=words):
        load_dataset([mixed, tmp_path], Selection())


def test_an_export_names_the_robots(mixed: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    export.main([str(mixed), "--format", "lerobot", "--out", str(out)], standalone_mode=False)
    info = json.loads((out / "meta" / "info.json").read_text())
    assert info["robot_type"] == "Franka Emika Panda + Universal Robots UR5e"


def test_a_policy_sits_only_where_its_arms_are() -> None:
    policy = Wanderer()
    policy.arm_kinds = KINDS
    require_fit(policy, get_task(recorded.TASK, kinds=KINDS))
    with pytest.raises(InvalidInput, match=r"trained with panda, ur5e \(arm_kinds\) and the room has Pandas"):
        require_fit(policy, get_task(recorded.TASK))
    assert common_task([policy]).arm_kinds == KINDS
    with pytest.raises(
        InvalidInput, match=r"several kinds of arms \(arm_kinds\) were given: Pandas; panda, ur5e"
    ):
        common_task([policy, Wanderer()])


def test_an_arm_without_fingers_is_recorded_exported_and_learned_from(tmp_path: Path) -> None:
    kinds = ("panda", "panda", "ur5e+wiping_pad")
    world, folder = World.build(WIPING, kinds=kinds), tmp_path / "episodes"
    path = recorded.write(folder, world, recorded.perform(world, seed=1, most_ticks=20), task=WIPING)
    file = open_episode(path)
    assert file.episode.arm_kinds == kinds
    assert "arm1/gripper" in file.arrays().observations
    assert "arm2/gripper" not in file.arrays().observations
    learned = load_dataset([folder], Selection())
    assert learned.digest.arm_kinds == kinds
    out = tmp_path / "out"
    export.main([str(folder), "--format", "lerobot", "--out", str(out)], standalone_mode=False)
    assert "Universal Robots UR5e with Wiping pad" in (out / "meta" / "info.json").read_text()
    spec = {"model": "none/joint/joint/mlp/gmm", "seeds": (0,), "preset": "debug", "data": (folder,)}
    progress: list[TrainingProgress] = []
    train(TrainingSpec.model_validate(spec), tmp_path / "run", threading.Event(), progress.append)
    assert progress
