"""What the arms do with their commands."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.world import World

TASK = "two_arm_multi_cube_lifting"


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def drive(world: World, targets: dict[str, Pose], ticks: int, gripper: float = 0.0) -> NDArray[np.float64]:
    """The tools' positions in their base frames after each tick, shape (ticks, arms, 3)."""
    track = []
    for _ in range(ticks):
        world.step(np.array([world.action_for(arm, targets[arm], gripper) for arm in world.arms]))
        track.append([world.tool_pose_in_base(arm).position for arm in world.arms])
    return np.array(track)


def tools(world: World) -> dict[str, Pose]:
    return {arm: world.tool_pose_in_base(arm) for arm in world.arms}


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1, 1])
def test_step_response(world: World, axis: int, sign: int) -> None:
    world.reset(0)
    start = tools(world)
    shift = sign * 0.05 * np.eye(3)[axis]
    targets = {arm: Pose(pose.position + shift, pose.quaternion_wxyz) for arm, pose in start.items()}
    track = drive(world, targets, 30)
    for index, arm in enumerate(world.arms):
        covered = (track[:, index] - start[arm].position) @ shift / 0.05**2
        assert covered.max() < 1.02
        assert covered[9] > 0.8  # half a second
        assert covered[-1] == pytest.approx(1.0, abs=0.002)
        assert (
            np.abs(
                (track[:, index] - start[arm].position) @ (np.eye(3) - np.outer(shift, shift) / 0.05**2)
            ).max()
            < 0.002
        )


def test_turning_on_the_spot(world: World) -> None:
    world.reset(0)
    start = tools(world)
    turn = Pose.exp([0, 0, 0, 0.2, 0.3, 0.4])
    targets = {
        arm: Pose(pose.position, (turn @ Pose(np.zeros(3), pose.quaternion_wxyz)).quaternion_wxyz)
        for arm, pose in start.items()
    }
    track = drive(world, targets, 30)
    for index, arm in enumerate(world.arms):
        assert targets[arm].distance_to(world.tool_pose_in_base(arm))[1] < 0.002
        assert np.abs(track[:, index] - start[arm].position).max() < 0.003


def test_holding_still(world: World) -> None:
    world.reset(0)
    start = tools(world)
    drive(world, start, 100)
    for arm in world.arms:
        metres, radians = start[arm].distance_to(world.tool_pose_in_base(arm))
        assert metres < 1e-5
        assert radians < 1e-5


@pytest.mark.parametrize("control_hz", [20.0, 30.0, 60.0])
def test_top_speed_does_not_depend_on_the_tick_rate(control_hz: float) -> None:
    world = World.build(TASK, control_hz)
    world.reset(0)
    targets = {
        arm: Pose(pose.position + np.array([0.25, 0, 0]), pose.quaternion_wxyz)
        for arm, pose in tools(world).items()
    }
    track = drive(world, targets, round(1.5 * control_hz))
    speed = np.diff(track[:, 0, 0]).max() / world.control_period_s
    assert 0.25 < speed < 0.30


@pytest.mark.parametrize("seed", range(12))
def test_wild_targets_do_no_harm(world: World, seed: int) -> None:
    random = np.random.default_rng(seed)
    world.reset(seed)
    start = tools(world)
    wild = {arm: Pose.exp([*(random.normal(size=3) * 1.5), *random.normal(size=3)]) for arm in world.arms}
    drive(world, wild, 60)
    assert np.abs(world.data.qvel).max() < 30
    drive(world, start, 120)
    for arm in world.arms:
        assert start[arm].distance_to(world.tool_pose_in_base(arm))[0] < 0.002


def test_the_gripper_closes_in_some_ticks_and_opens_again(world: World) -> None:
    world.reset(0)
    start = tools(world)
    assert world.gripper("arm0") == pytest.approx(0.0, abs=1e-6)
    drive(world, start, 3, gripper=1.0)
    assert 0.2 < world.gripper("arm0") < 0.9
    drive(world, start, 7, gripper=1.0)
    assert world.gripper("arm0") == pytest.approx(1.0, abs=0.01)
    drive(world, start, 12, gripper=0.0)
    assert world.gripper("arm0") == pytest.approx(0.0, abs=0.02)


def test_a_held_cube_stays_where_it_is_held(world: World) -> None:
    """10 s of holding still, then 5 s of shaking by 3 cm on all axes."""
    world.reset(5)
    grasp = {arm: Pose(np.array([0.5, 0.0, 0.02]), Pose.identity().quaternion_wxyz) for arm in world.arms}
    up = {arm: Pose(np.array([0.5, 0.0, 0.25]), Pose.identity().quaternion_wxyz) for arm in world.arms}
    for arm in world.task.arms:
        x, y, z = arm.pose_base_in_world.transform_points((0.5, 0.0, 0.02))
        world.data.joint(arm.name.replace("arm", "cube")).qpos = (
            x,
            y,
            z,
            *arm.pose_base_in_world.quaternion_wxyz,
        )
    drive(world, grasp, 30)
    drive(world, grasp, 12, gripper=1.0)
    drive(world, up, 30, gripper=1.0)

    first = in_hand(world)
    drive(world, up, 200, gripper=1.0)
    assert np.abs(in_hand(world) - first).max() < 0.0002
    for tick in range(100):
        shake = 0.03 * np.sin(2 * np.pi * 0.9 * tick / 20 + np.arange(3))
        drive(world, {a: Pose(p.position + shake, p.quaternion_wxyz) for a, p in up.items()}, 1, gripper=1.0)
    drive(world, up, 20, gripper=1.0)
    assert np.abs(in_hand(world) - first).max() < 0.0005
    assert abs(world.tool_pose_in_base("arm0").position[2] - 0.25) < 0.002  # steady sag under 0.1 kg


def in_hand(world: World) -> NDArray[np.float64]:
    """The cubes seen from the tools, shape (arms, 3), along the base axes."""
    return np.array(
        [
            arm.pose_base_in_world.inverse().transform_points(
                world.data.body(arm.name.replace("arm", "cube")).xpos
            )
            - world.tool_pose_in_base(arm.name).position
            for arm in world.task.arms
        ]
    )
