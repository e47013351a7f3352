"""Arms that are sent out of reach come back."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from mart.sim.world import World

OUT_M = 1.5

# (seed, arm, direction in the base frame): random trials after which an elbow that may straighten up to the datasheet's
# limit stays stretched for good.
WEDGES = (
    (78, "arm1", (-0.49, -0.11, 0.87)),
    (81, "arm0", (-0.45, -0.22, 0.86)),
    (91, "arm1", (0.12, 0.84, -0.53)),
    (1079, "arm1", (-0.48, 0.15, 0.86)),
    (2053, "arm1", (0.29, 0.77, -0.57)),
    (2083, "arm1", (0.16, -0.76, -0.63)),
    (2084, "arm1", (-0.20, -0.96, 0.20)),
)


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.mark.parametrize(("seed", "arm", "direction"), WEDGES)
def test_an_arm_comes_back_from_a_goal_out_of_reach(
    world: World, seed: int, arm: str, direction: tuple[float, float, float]
) -> None:
    world.reset(seed)
    home = world.tool_pose_in_base(arm)
    index, goal = world.arms.index(arm), home.position + OUT_M * np.array(direction)
    for _ in range(60):
        act(world, index, straight_towards(goal - world.tool_pose_in_base(arm).position))
    assert world.tool_pose_in_base(arm).distance_to(home)[0] > 0.2
    for _ in range(120):
        act(world, index, world.action_for(arm, home, gripper=0.0))
    metres, radians = world.tool_pose_in_base(arm).distance_to(home)
    assert metres < 0.002
    assert radians < 0.01


def straight_towards(shift_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """A policy's action: nothing clamps it to the workspace."""
    return np.array([*(shift_m / np.linalg.norm(shift_m)), 0.0, 0.0, 0.0, -1.0])


def act(world: World, index: int, action: NDArray[np.float64]) -> None:
    actions = np.array([[0.0] * 6 + [-1.0]] * len(world.arms))
    actions[index] = action
    world.step(actions)


def test_the_elbow_straightens_up_to_the_longest_reach_and_no_further(world: World) -> None:
    data, joint = mujoco.MjData(world.model), world.model.joint("arm0/joint4")
    data.qpos[:] = world.data.qpos
    lowest_rad, highest_rad = joint.range
    reach_m = []
    for angle_rad in np.linspace(lowest_rad, highest_rad, 200):
        data.qpos[joint.qposadr[0]] = angle_rad
        mujoco.mj_kinematics(world.model, data)
        shoulder, wrist = data.joint("arm0/joint2").xanchor, data.joint("arm0/joint6").xanchor
        reach_m.append(np.linalg.norm(wrist - shoulder))
    assert (np.diff(reach_m) > 0).all()
    assert reach_m[-1] == pytest.approx(np.hypot(0.0825, 0.316) + np.hypot(0.0825, 0.384), abs=1e-3)
