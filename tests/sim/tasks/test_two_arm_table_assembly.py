from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.protocol.pose import quaternion_exp, quaternion_multiply
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World
from tests.sim.tasks.driving import (
    LYING,
    UPRIGHT,
    drive,
    grip,
    in_hand,
    pose_of,
    put,
    raised,
    steps,
    tool_over,
    tools,
)

TASK = "two_arm_table_assembly"
SOCKET_X_M, SEAT_Z_M, TOP_SEATED_Z_M = 0.12, 0.01, 0.16
NECK = (0.0, 0.0, 0.117)  # of a column
KNOBS = {"arm0": (-0.205, 0.0, 0.0), "arm1": (0.205, 0.0, 0.0)}


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def assemble(world: World, *, top: bool) -> None:
    """Both columns in their sockets, and the tabletop on them: put there."""
    world.reset(0)
    base = pose_of(world, "table_base")
    places = {"column0": (-SOCKET_X_M, 0.0, SEAT_Z_M), "column1": (SOCKET_X_M, 0.0, SEAT_Z_M)}
    if top:
        places["tabletop"] = (0.0, 0.0, TOP_SEATED_Z_M)
    for thing, place in places.items():
        put(world, thing, base.transform_points(place), base.quaternion_wxyz)


def test_resets_cover_the_range_and_everything_lies_still(world: World) -> None:
    places = []
    for seed in range(40):
        world.reset(seed)
        before = world.observations()
        drive(world, tools(world), 2)
        moved = [
            np.abs(world.observations()[name] - before[name]).max() for name in before if "column" in name
        ]
        assert max(moved) < 0.001
        places.append([*before["column0/position_in_world"][:2], *before["table_base/position_in_world"][:2]])
    spread = np.array(places) - (-0.20, -0.25, 0.0, -0.02)
    assert np.abs(spread).max(axis=0) == pytest.approx([0.03, 0.03, 0.02, 0.02], abs=0.004)


def test_an_assembled_table_is_a_success_once_both_have_let_go(world: World) -> None:
    assemble(world, top=True)
    progress = drive(world, tools(world), 12)
    assert list(progress.subtasks.values()) == [True] * 4
    assert progress.success
    held = grip(world, {"arm0": pose_of(world, "tabletop").transform_points(KNOBS["arm0"])})
    progress = drive(world, held, 1, arm0=1.0)
    assert progress.subtasks["tabletop_seated"]
    assert not progress.success_now


@pytest.mark.parametrize(("off_m", "seated"), [(0.0, True), (0.007, True), (0.025, False)])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_column_finds_its_socket_within_seven_millimetres(
    world: World, axis: int, off_m: float, seated: bool
) -> None:
    """Let fall from just over the walls: the balls under its foot lead it in."""
    assemble(world, top=False)
    column = pose_of(world, "column0")
    put(world, "column0", (*(column.position + off_m * np.eye(3)[axis])[:2], 0.025), column.quaternion_wxyz)
    assert drive(world, tools(world), 30).subtasks["column0_seated"] == seated


@pytest.mark.parametrize(("off_m", "seated"), [(0.005, True), (0.010, True), (0.025, False)])
def test_the_tabletop_finds_the_pegs_within_a_centimetre(world: World, off_m: float, seated: bool) -> None:
    assemble(world, top=True)
    top = pose_of(world, "tabletop")
    put(world, "tabletop", top.position + np.array([off_m, 0.0, 0.03]), top.quaternion_wxyz)
    assert drive(world, tools(world), 40).subtasks["tabletop_seated"] == seated


@pytest.mark.parametrize(
    ("thing", "position", "turn", "failed"),
    [
        ("column1", (0.2, -0.2, 0.03), LYING, None),
        ("column0", (-0.7, 0.0, 0.0), UPRIGHT, "Column 0 fell off the table."),
        ("tabletop", (0.0, 0.6, 0.1), UPRIGHT, "The tabletop fell off the table."),
        ("tabletop", (0.0, 0.3, 0.3), LYING, "The tabletop tipped over."),
    ],
)
def test_what_cannot_be_mended_ends_it(
    world: World, thing: str, position: tuple[float, ...], turn: tuple[float, ...], failed: str | None
) -> None:
    world.reset(0)
    put(world, thing, position, turn)
    assert world.progress().failed == failed


@pytest.mark.slow
@given(
    yaw_rad=st.floats(-math.pi, math.pi),
    lean_rad=st.floats(-0.2, 0.2),
    lean_towards_rad=st.floats(-math.pi, math.pi),
)
@settings(max_examples=20)
def test_a_column_that_is_dropped_five_centimetres_stays_up(
    world: World, yaw_rad: float, lean_rad: float, lean_towards_rad: float
) -> None:
    world.reset(0)
    axis = np.array([math.cos(lean_towards_rad), math.sin(lean_towards_rad), 0.0])
    turn = quaternion_multiply(quaternion_exp(lean_rad * axis), quaternion_exp(np.array([0, 0, yaw_rad])))
    put(world, "column0", (-0.2, -0.2, 0.05), turn)
    drive(world, tools(world), 30)
    assert pose_of(world, "column0").rotation_matrix()[2, 2] > 0.999


@pytest.mark.parametrize("yaw_rad", [0.0, 0.8, -1.2])
def test_a_column_that_lies_rises_when_it_is_lifted_by_its_neck(world: World, yaw_rad: float) -> None:
    world.reset(0)
    turn = quaternion_multiply(
        quaternion_exp(np.array([0, 0, yaw_rad])), quaternion_exp(np.array([0, math.pi / 2, 0]))
    )
    put(world, "column0", (-0.25, -0.2, 0.035), turn)
    drive(world, tools(world), 10)
    column = pose_of(world, "column0")
    assert column.rotation_matrix()[2, 2] < 0.2
    held = grip(world, {"arm0": column.transform_points(NECK)}, yaw_rad)
    drive(world, raised(held, ("arm0",), 0.16), 60, arm0=1.0)
    assert pose_of(world, "column0").rotation_matrix()[2, 2] > 0.98


@pytest.mark.slow
def test_a_column_is_held_for_half_a_minute_by_friction_alone(world: World) -> None:
    world.reset(3)
    held = grip(world, {"arm0": pose_of(world, "column0").transform_points(NECK)})
    up = raised(held, ("arm0",), 0.15)
    drive(world, up, 40, arm0=1.0)
    first = in_hand(world, "arm0", "column0")
    drive(world, up, 600, arm0=1.0)
    metres, radians = first.distance_to(in_hand(world, "arm0", "column0"))
    assert metres < 0.002
    assert radians < 0.03


@pytest.mark.slow
def test_both_arms_hold_the_tabletop_up_for_half_a_minute(world: World) -> None:
    world.reset(5)
    top = pose_of(world, "tabletop")
    held = grip(world, {arm: top.transform_points(knob) for arm, knob in KNOBS.items()})
    up = raised(held, world.arms, 0.1)
    assert drive(world, up, 60, arm0=1.0, arm1=1.0).subtasks["tabletop_lifted"]
    first = pose_of(world, "tabletop")
    assert drive(world, up, 600, arm0=1.0, arm1=1.0).subtasks["tabletop_lifted"]
    assert first.distance_to(pose_of(world, "tabletop"))[0] < 0.002


@pytest.mark.parametrize("arm", ["arm0", "arm1"])
def test_one_arm_alone_cannot_lift_the_tabletop(world: World, arm: str) -> None:
    assemble(world, top=False)
    held = grip(world, {arm: pose_of(world, "tabletop").transform_points(KNOBS[arm])})
    for height_m in (0.02, 0.05, 0.1, 0.2, 0.25):
        for progress in steps(world, raised(held, (arm,), height_m), 40, {arm: 1.0}):
            assert not progress.subtasks["tabletop_lifted"]
            assert not progress.subtasks["tabletop_seated"]
    assert (
        pose_of(world, "tabletop").rotation_matrix()[2, 2] < 0.95
    )  # it hangs from the knob, which did not slip


def test_neither_arm_reaches_the_other_s_knob_or_socket(world: World) -> None:
    world.reset(0)
    for arm, other in (("arm0", "arm1"), ("arm1", "arm0")):
        knob = tool_over(world, arm, pose_of(world, "tabletop").transform_points(KNOBS[other]))
        assert world.task.arm(arm).kind.workspace.clamp(knob).distance_to(knob)[0] > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("control_hz", [20.0, 30.0, 60.0])
def test_experts_assemble_it_at_every_rate(control_hz: float) -> None:
    assert run_experts(World.build(TASK, control_hz), seed=1, until_s=25.0).success
