from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.pose import Pose
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World
from tests.sim.tasks.driving import (
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

TASK = "two_arm_pick_place_handover"
LID_KNOB = (0.0, 0.0, 0.024)
ENDS = {"arm0": (-0.055, 0.0, 0.0), "arm1": (0.075, 0.0, 0.0)}  # of the hammer, where each grips it
OFFER = (0.0, 0.0, 0.25)


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


def put_lid_away(world: World) -> None:
    put(world, "lid", (-0.27, -0.16, 0.08))


def grip_in_the_air(world: World, arms: tuple[str, ...]) -> dict[str, Pose]:
    """A hammer without weight between the arms, gripped by these; where the tools have been sent."""
    world.reset(0)
    put_lid_away(world)
    put(world, "hammer", OFFER)
    world.model.opt.gravity[:] = 0
    try:
        held = grip(world, {arm: pose_of(world, "hammer").transform_points(ENDS[arm]) for arm in arms})
    finally:
        world.model.opt.gravity[2] = -9.81
    return held


def test_resets_cover_the_range_and_everything_lies_still(world: World) -> None:
    places = []
    for seed in range(40):
        world.reset(seed)
        drive(world, tools(world), 4)
        before = world.observations()
        drive(world, tools(world), 4)
        moved = [
            np.abs(world.observations()[name] - before[name]).max() for name in before if "arm" not in name
        ]
        assert max(moved) < 0.001
        places.append((before["trash/position_in_world"] - before["bin/position_in_world"])[:2])
    assert np.abs(places).max(axis=0) == pytest.approx([0.06, 0.03], abs=0.006)


def test_the_container_is_open_when_the_lid_lies_beside_it(world: World) -> None:
    world.reset(0)
    put(world, "lid", (-0.27, -0.16, 0.2))
    assert not world.progress().subtasks["lid_removed"]
    put_lid_away(world)
    assert world.progress().subtasks["lid_removed"]


def test_the_trash_belongs_in_the_tray(world: World) -> None:
    world.reset(0)
    tray = pose_of(world, "trash_tray")
    put(world, "trash", tray.transform_points((0.08, 0.0, 0.02)))
    assert not world.progress().subtasks["trash_cleared"]
    put(world, "trash", tray.transform_points((0.05, 0.0, 0.02)))
    assert world.progress().subtasks["trash_cleared"]


def test_a_hammer_that_nobody_handed_over_does_not_count(world: World) -> None:
    world.reset(0)
    put(world, "trash", pose_of(world, "trash_tray").transform_points((0.0, 0.0, 0.02)))
    put(world, "hammer", pose_of(world, "bin").transform_points((0.0, 0.0, 0.015)))
    progress = drive(world, tools(world), 12)
    assert progress.subtasks["hammer_fetched"]
    assert not progress.subtasks["hammer_placed"]
    assert not progress.success


def test_from_hand_to_hand_is_a_handover(world: World) -> None:
    both = grip_in_the_air(world, ("arm0", "arm1"))
    assert not drive(world, both, 1, arm0=1.0, arm1=1.0).subtasks["hammer_handed_over"]
    assert drive(world, both, 12, arm1=1.0).subtasks["hammer_handed_over"]
    assert drive(world, both, 40).subtasks["hammer_handed_over"]  # once done, it is done


def test_each_operator_is_told_what_to_do_while_both_hold_it(world: World) -> None:
    both = grip_in_the_air(world, ("arm0", "arm1"))
    drive(world, both, 1, arm0=1.0, arm1=1.0)
    assert world.to_do("arm0") == "Your partner has it: let go now."
    drive(world, both, 12, arm1=1.0)
    assert world.to_do("arm0") == world.task.afterwards
    assert "trash" in world.to_do("arm1")


def test_who_holds_it_at_the_partners_end_is_told(world: World) -> None:
    world.reset(0)
    put_lid_away(world)
    assert "close to its head" in world.to_do("arm0")
    targets = tools(world)
    put(world, "hammer", (world.data.site("arm0/tool").xpos - (0.06, 0.0, 0.0)).tolist())
    world.model.opt.gravity[:] = 0
    try:
        drive(world, targets, 12, arm0=1.0)
    finally:
        world.model.opt.gravity[2] = -9.81
    assert world.to_do("arm0").startswith("Lay the hammer down")


def test_from_hand_to_hand_the_other_way_is_none(world: World) -> None:
    both = grip_in_the_air(world, ("arm0", "arm1"))
    assert not drive(world, both, 12, arm0=1.0).subtasks["hammer_handed_over"]


def test_a_hammer_taken_out_of_the_air_is_none(world: World) -> None:
    alone = grip_in_the_air(world, ("arm1",))
    for progress in steps(world, alone, 20, {"arm1": 1.0}):
        assert not progress.subtasks["hammer_handed_over"]


@pytest.mark.parametrize(
    ("thing", "position", "failed"),
    [
        ("hammer", (-0.55, 0.0, 0.01), "The hammer fell off the shelf."),
        ("trash", (0.0, -0.5, 0.02), "The trash fell off the shelf."),
        ("hammer", (0.1, 0.0, 0.075), None),
    ],
)
def test_what_cannot_be_mended_ends_it(
    world: World, thing: str, position: tuple[float, ...], failed: str | None
) -> None:
    world.reset(0)
    put(world, thing, position)
    assert world.progress().failed == failed


@pytest.mark.slow
@pytest.mark.parametrize("arm", ["arm0", "arm1"])
def test_a_hammer_is_held_for_half_a_minute_at_either_end_by_friction_alone(world: World, arm: str) -> None:
    up = raised(grip_in_the_air(world, (arm,)), (arm,), 0.05)
    drive(world, up, 40, **{arm: 1.0})
    first = in_hand(world, arm, "hammer")
    drive(world, up, 600, **{arm: 1.0})
    metres, radians = first.distance_to(in_hand(world, arm, "hammer"))
    assert metres < 0.004
    assert radians < 0.05


@pytest.mark.slow
def test_the_lid_is_held_for_half_a_minute_by_friction_alone(world: World) -> None:
    world.reset(0)
    up = raised(grip(world, {"arm0": pose_of(world, "lid").transform_points(LID_KNOB)}), ("arm0",), 0.1)
    drive(world, up, 40, arm0=1.0)
    first = in_hand(world, "arm0", "lid")
    drive(world, up, 600, arm0=1.0)
    assert first.distance_to(in_hand(world, "arm0", "lid"))[0] < 0.002


def test_arm_0_reaches_no_bin_and_arm_1_no_container(world: World) -> None:
    world.reset(0)
    for arm, box, nearest_m in (("arm0", "bin", -0.165), ("arm1", "container", 0.155)):
        near = tool_over(world, arm, pose_of(world, box).transform_points((nearest_m, 0.0, 0.05)))
        assert world.task.arm(arm).kind.workspace.clamp(near).distance_to(near)[0] > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("control_hz", [20.0, 30.0, 60.0])
def test_experts_hand_it_over_at_every_rate(control_hz: float) -> None:
    assert run_experts(World.build(TASK, control_hz), seed=1, until_s=30.0).success
