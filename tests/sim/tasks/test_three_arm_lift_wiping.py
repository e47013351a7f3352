from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.protocol.tasks.three_arm_lift_wiping import RACK_TOP_M, SPOTS_M
from mart.sim.world import World
from mart.sim.world.batch import WorldBatch
from tests.sim.tasks.tray import lift_alone, shift, tilt

TASK = "three_arm_lift_wiping"
REST = np.tile([0.0] * 6 + [-1.0], (3, 1))
LYING_M = 0.015  # of the sponge's middle


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def put_sponge(world: World, x_m: float, y_m: float, z_m: float = LYING_M, roll_rad: float = 0.0) -> None:
    """Its length along y, as it is at the start."""
    turn, roll = np.zeros(4), np.array([np.cos(roll_rad / 2), np.sin(roll_rad / 2), 0.0, 0.0])
    mujoco.mju_mulQuat(turn, np.array([np.sqrt(0.5), 0.0, 0.0, -np.sqrt(0.5)]), roll)
    world.data.joint("sponge").qpos[:] = (x_m, y_m, z_m, *turn)
    mujoco.mj_kinematics(world.model, world.data)
    world._scene.remember()


def wiped(world: World) -> set[tuple[float, float]]:
    flags = world.observations()["dirt/wiped"]
    return {spot for spot, flag in zip(SPOTS_M, flags, strict=True) if flag}


def visible(world: World) -> list[bool]:
    """Which spots somebody who renders the state sees."""
    viewer = mujoco.MjData(world.model)
    state = np.frombuffer(world.integration_state(), "<f8")
    mujoco.mj_setState(world.model, viewer, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    mujoco.mj_kinematics(world.model, viewer)
    return [bool(viewer.body(f"dirt{i}").xpos[2] > 0.0) for i in range(len(SPOTS_M))]


def test_resets_hide_the_dirt_under_the_tray(world: World) -> None:
    half_m = np.array([0.17, 0.13])
    for seed in range(40):
        world.reset(seed)
        assert world.progress().failed is None
        tray = world.data.body("tray")
        spots = np.column_stack([SPOTS_M, np.zeros(len(SPOTS_M))])
        in_tray = (spots - tray.xpos) @ tray.xmat.reshape(3, 3)
        assert (np.abs(in_tray[:, :2]) < half_m).all()


def test_all_things_lie_still_after_a_reset(world: World) -> None:
    world.reset(0)
    names = ("drinks/positions_in_world", "tray/position_in_world", "sponge/position_in_world")
    before = world.observations()
    for _ in range(20):
        world.step(REST)
    after = world.observations()
    assert max(np.abs(after[name] - before[name]).max() for name in names) < 0.0006
    assert not wiped(world)


def test_what_the_sponge_lies_on_is_wiped(world: World) -> None:
    world.reset(0)
    put_sponge(world, -0.06, -0.04)
    assert wiped(world) == {(-0.06, -0.06), (-0.06, -0.02)}
    put_sponge(world, 0.06, 0.04)
    assert wiped(world) == {(-0.06, -0.06), (-0.06, -0.02), (0.06, 0.06), (0.06, 0.02)}


def test_only_a_sponge_that_lies_flat_wipes(world: World) -> None:
    world.reset(0)
    put_sponge(world, 0.0, 0.0, z_m=LYING_M + 0.004)
    put_sponge(world, 0.0, 0.0, z_m=LYING_M, roll_rad=np.pi / 2)
    assert not wiped(world)


def test_what_is_wiped_is_out_of_everybodys_sight_and_a_reset_brings_it_back(world: World) -> None:
    world.reset(0)
    assert visible(world) == [True] * len(SPOTS_M)
    put_sponge(world, 0.02, 0.04)
    assert visible(world) == [spot not in wiped(world) for spot in SPOTS_M]
    state = world.integration_state()
    world.reset(1)
    assert visible(world) == [True] * len(SPOTS_M)
    world.set_integration_state(state)
    assert len(wiped(world)) == len(SPOTS_M) - sum(visible(world)) == 2


@pytest.mark.parametrize(
    ("by_m", "carried"),
    [((0, -0.35, 0.0), False), ((0, -0.35, 0.05), True), ((0, -0.20, 0.05), False)],
)
def test_a_tray_is_carried_when_it_is_up_and_aside(
    world: World, by_m: tuple[float, float, float], carried: bool
) -> None:
    world.reset(0)
    shift(world, by_m)
    assert world.progress().subtasks == {
        "lift_tray": by_m[2] > 0.04,
        "carry_tray": carried,
        "wipe_table": False,
    }


def test_success_is_a_clean_table_and_drinks_on_the_rack(world: World) -> None:
    world.reset(0)
    for x_m, y_m in SPOTS_M:
        put_sponge(world, x_m, y_m)
    assert world.progress().subtasks["wipe_table"]
    assert not world.progress().success_now
    shift(world, RACK_TOP_M)
    assert world.progress().success_now
    tilt(world, "drink0", 0.7)
    assert not world.progress().success_now
    assert world.progress().failed == "A drink tipped over."


def test_a_sponge_off_the_table_ends_it(world: World) -> None:
    world.reset(0)
    put_sponge(world, 0.7, 0.0, z_m=-0.2)
    assert world.progress().failed == "The sponge fell off the table."


@pytest.mark.parametrize("arm", ["arm0", "arm1"])
def test_one_carrier_alone_cannot_lift_the_tray(world: World, arm: str) -> None:
    world.reset(1)
    lifted, failed = lift_alone(world, arm)
    assert not lifted
    assert failed == "A drink tipped over."


def test_a_batch_wipes_as_its_worlds_alone_do(world: World) -> None:
    batch = WorldBatch(world, size=2, threads=1)
    batch.reset([3, 4])
    for row, place in zip(batch._batch.state, [(0.06, 0.04), (-0.02, -0.04)], strict=True):
        world.set_integration_state(row.astype("<f8").tobytes())
        put_sponge(world, *place)
        row[:] = np.frombuffer(world.integration_state(), "<f8")
    begun = batch._batch.state.copy()
    for _ in range(3):
        batch.step(np.stack([REST, REST]), np.ones(2, np.bool_))
    states = batch.integration_states()
    for number in range(2):
        world.set_integration_state(begun[number].astype("<f8").tobytes())
        for _ in range(3):
            world.step(REST)
        assert len(wiped(world)) == 2
        assert states[number].tobytes() == world.integration_state()
