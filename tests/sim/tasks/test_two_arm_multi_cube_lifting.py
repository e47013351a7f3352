from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.sim.world import World

LEVEL = (1.0, 0.0, 0.0, 0.0)
ON_EDGE = (np.cos(np.pi / 8), np.sin(np.pi / 8), 0.0, 0.0)


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


def put(world: World, cube: str, z_m: float, quaternion_wxyz: tuple[float, ...] = LEVEL) -> None:
    world.data.joint(cube).qpos[2:] = (z_m, *quaternion_wxyz)
    mujoco.mj_kinematics(world.model, world.data)


def test_resets_cover_the_range_and_stay_in_reach(world: World) -> None:
    positions = []
    for seed in range(60):
        world.reset(seed)
        for arm in world.task.arms:
            cube = world.data.body(arm.name.replace("arm", "cube")).xpos
            positions.append(arm.pose_base_in_world.inverse().transform_points(cube))
    offset = np.array(positions) - (0.54, 0.0, 0.02)
    assert np.abs(offset).max(axis=0) == pytest.approx([0.08, 0.20, 0.0], abs=0.01)
    radius = np.hypot(*np.array(positions)[:, :2].T)
    assert radius.min() > 0.40
    assert radius.max() < 0.70


def test_cubes_lie_still_after_a_reset(world: World) -> None:
    world.reset(0)
    before = world.observations()
    for _ in range(20):
        world.step([[0, 0, 0, 0, 0, 0, -1]] * 2)
    after = world.observations()
    for cube in ("cube0", "cube1"):
        assert np.abs(after[f"{cube}/position_in_world"] - before[f"{cube}/position_in_world"]).max() < 0.0005


@pytest.mark.parametrize(("z_m", "up"), [(0.1199, False), (0.1201, True)])
def test_a_cube_is_up_when_its_underside_is_over_10_cm(world: World, z_m: float, up: bool) -> None:
    world.reset(0)
    put(world, "cube0", z_m)
    assert world.progress().subtasks == {"lift_cube0": up, "lift_cube1": False}
    assert not world.progress().success_now


def test_the_lowest_corner_counts(world: World) -> None:
    world.reset(0)
    put(world, "cube0", 0.12 + 0.02 * (2**0.5 - 1) - 0.0001, ON_EDGE)
    assert not world.progress().subtasks["lift_cube0"]
    put(world, "cube0", 0.12 + 0.02 * (2**0.5 - 1) + 0.0001, ON_EDGE)
    assert world.progress().subtasks["lift_cube0"]


def test_success_needs_both_for_ten_ticks_in_a_row(world: World) -> None:
    world.reset(0)
    world.model.opt.gravity[:] = 0
    try:
        counts = []
        for tick in range(25):
            for cube in ("cube0", "cube1"):
                put(world, cube, 0.05 if tick == 5 else 0.3)
            world.data.qvel[:] = 0
            world.step(np.zeros((2, 7)))
            progress = world.progress()
            assert progress.success == (progress.success_ticks >= 10)
            counts.append(progress.success_ticks)
    finally:
        world.model.opt.gravity[2] = -9.81
    assert counts == [1, 2, 3, 4, 5, 0, *range(1, 20)]


def test_a_cube_off_the_table_ends_it(world: World) -> None:
    world.reset(0)
    put(world, "cube1", -0.2)
    assert world.progress().failed == "Cube 1 fell off the table."
