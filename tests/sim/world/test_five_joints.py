"""An arm of five joints (tests/support/arms): what it keeps, what it gives up, and that it is told."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.arms import arm_kind
from mart.protocol.pose import Pose
from mart.sim.arm_check import check_arm
from mart.sim.experts.hand_motion import difference
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World
from mart.sim.world.reach import missed

ARM = "arm0"
TILT = 3  # the direction that it lacks with its tool straight down: about the way it reaches
STEP = np.array([0.05, 0.05, 0.05, 0.2, 0.2, 0.2])  # metres, radians


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MART_ARMS_DIR", str(Path(__file__).parents[2] / "support/arms"))
        yield World.build("two_arm_multi_cube_lifting", kinds=("five_joints", "panda"))


def moved(world: World, delta: NDArray[np.float64], ticks: int = 30) -> NDArray[np.float64]:
    """How far the tool gets that is asked to go so far, shape (6,), along and about the axes of its base."""
    world.reset(0)
    start = world.tool_pose_in_base(ARM)
    other = world.tool_pose_in_base("arm1")
    goal = Pose(start.position + delta[:3], (Pose.exp(np.r_[0, 0, 0, delta[3:]]) @ start).quaternion_wxyz)
    for _ in range(ticks):
        world.step([world.action_for(ARM, goal, 0.0), world.action_for("arm1", other, 0.0)])
    return np.concatenate(difference(world.tool_pose_in_base(ARM), start))


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("axis", [0, 1, 2, 4, 5])
def test_it_goes_where_its_joints_can(world: World, axis: int, sign: int) -> None:
    asked = sign * STEP * np.eye(6)[axis]
    left = np.delete(moved(world, asked) - asked, TILT)
    assert np.abs(left[:3]).max() < 0.001
    assert np.abs(left[3:]).max() < 0.02


def test_what_it_lacks_is_given_up_and_the_rest_holds(world: World) -> None:
    way = moved(world, 0.35 * np.eye(6)[TILT])
    assert abs(way[TILT]) < 0.05
    assert np.abs(way[:3]).max() < 0.002
    assert np.abs(way[4:]).max() < 0.05


def test_it_comes_back_from_out_of_reach(world: World) -> None:
    moved(world, np.array([0.6, 0.6, 0.0, 0.0, 0.0, 0.0]), ticks=60)
    assert np.abs(world.data.qvel).max() < 1.0
    world_start = world.tool_pose_in_base(ARM)
    home = Pose(np.array([0.45, 0.0, 0.2]), Pose.identity().quaternion_wxyz)
    other = world.tool_pose_in_base("arm1")
    for _ in range(100):
        world.step([world.action_for(ARM, home, 0.0), world.action_for("arm1", other, 0.0)])
    assert home.distance_to(world_start)[0] > 0.2
    metres, radians = home.distance_to(world.tool_pose_in_base(ARM))
    assert (metres < 0.002, radians < 0.02) == (True, True)


def test_scripts_lift_cubes_with_it(world: World) -> None:
    assert missed(world) == ()
    assert run_experts(world, 0, until_s=world.task.trial_limit_s).success


def test_the_check_says_what_it_gives_up(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.sim.arm_check.task_names", lambda: ())
    monkeypatch.setenv("MART_ARMS_DIR", str(Path(__file__).parents[2] / "support/arms"))
    said = {finding.what: finding for finding in check_arm(arm_kind("five_joints"))}
    assert said["singularity"].said.startswith("Its 5 joints give up tilts to the side")
    assert [what for what, finding in said.items() if not finding.ok] == []
