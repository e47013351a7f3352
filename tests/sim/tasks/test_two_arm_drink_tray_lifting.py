from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.protocol.pose import Pose
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World
from tests.sim.tasks.tray import lift_alone, shift, tilt

TASK = "two_arm_drink_tray_lifting"


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def test_resets_cover_the_range_and_leave_the_drinks_standing(world: World) -> None:
    places = []
    for seed in range(60):
        world.reset(seed)
        assert world.progress().failed is None
        places.append(world.data.joint("tray").qpos[[0, 1, 6]])
    assert np.abs(places).max(axis=0) == pytest.approx([0.06, 0.06, np.sin(0.125)], abs=0.01)


def test_drinks_stand_still_after_a_reset(world: World) -> None:
    world.reset(0)
    before = world.observations()["drinks/positions_in_world"]
    for _ in range(20):
        world.step([[0, 0, 0, 0, 0, 0, -1]] * 2)
    assert np.abs(world.observations()["drinks/positions_in_world"] - before).max() < 0.0005


@pytest.mark.parametrize(("z_m", "up"), [(0.0999, False), (0.1001, True)])
def test_the_tray_is_up_when_its_underside_is_over_10_cm(world: World, z_m: float, up: bool) -> None:
    world.reset(0)
    shift(world, (0.0, 0.0, z_m))
    assert world.progress().subtasks == {"lift_tray": up}
    assert world.progress().success_now == up


def test_the_lowest_corner_counts(world: World) -> None:
    world.reset(0)
    shift(world, (0.0, 0.0, 0.12))
    assert world.progress().success_now
    tilt(world, "tray", 0.2)
    assert not world.progress().success_now


@pytest.mark.parametrize(("angle_rad", "failed"), [(0.5, None), (0.55, "A drink tipped over.")])
def test_a_drink_that_leans_by_30_degrees_has_tipped_over(
    world: World, angle_rad: float, failed: str | None
) -> None:
    world.reset(0)
    tilt(world, "drink2", angle_rad)
    assert world.progress().failed == failed


def test_a_drink_beside_the_tray_has_fallen_off(world: World) -> None:
    world.reset(0)
    world.data.joint("drink3").qpos[0] += 0.2
    mujoco.mj_kinematics(world.model, world.data)
    assert world.progress().failed == "A drink fell off the tray."


def test_success_is_held_for_one_and_a_half_seconds(world: World) -> None:
    assert world.task.success_hold_ticks * world.control_period_s == pytest.approx(1.5)


@pytest.mark.slow
def test_a_lifted_tray_is_held_for_half_a_minute_by_friction_alone(world: World) -> None:
    run_experts(world, 0)
    targets = {arm: world.tool_pose_in_base(arm) for arm in world.arms}
    settled = world.observations()
    for tick in range(600):
        if tick == 40:
            settled = world.observations()
        world.step([world.action_for(arm, target, gripper=1.0) for arm, target in targets.items()])
    held = world.observations()
    for arm in world.arms:
        handle = f"handle{arm[-1]}/position_in_world"
        slip = [seen[handle] - tool_in_world(world, seen, arm) for seen in (settled, held)]
        assert np.abs(slip[1] - slip[0]).max() < 0.002
    assert world.progress().success


def tool_in_world(world: World, seen: dict[str, np.ndarray], arm: str) -> np.ndarray:
    base = world.task.arm(arm).pose_base_in_world
    return (
        base @ Pose(seen[f"{arm}/tool_position_in_base"], seen[f"{arm}/tool_quaternion_in_base"])
    ).position


@pytest.mark.parametrize("arm", ["arm0", "arm1"])
def test_one_arm_alone_cannot_lift_it(world: World, arm: str) -> None:
    world.reset(1)
    lifted, failed = lift_alone(world, arm)
    assert not lifted
    assert failed == "A drink tipped over."
