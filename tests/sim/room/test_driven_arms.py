"""Drivers say hello, measure and are told; what is wrong with one stops the room, and everybody hears by name."""

from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.messages import (
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STOPPED,
    DRIVER_PHASE_FOLLOWING,
    ArmMeasured,
    EpisodeRequest,
)
from mart.protocol.wire_version import DRIVER_WIRE_VERSION
from mart.sim.room.clutches import Clutch
from mart.sim.world import World
from tests.sim.room.driven_room import HOME_RAD, DrivenRoom, Drivers, hello
from tests.sim.room.room_harness import RoomHarness


@pytest.fixture(scope="module")
def compiled() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture
def room(compiled: World) -> DrivenRoom:
    return DrivenRoom(compiled)


def test_a_room_stands_until_its_drivers_are_there_and_a_person_lets_it_go_on(room: DrivenRoom) -> None:
    room.pass_time(0.2)
    status = room.status()
    assert status.barrier == BARRIER_PHASE_STOPPED
    assert [arm.arm for arm in status.driven_arms] == ["arm0", "arm1"]
    assert all("No driver has connected" in arm.fault for arm in status.driven_arms)
    assert room.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == "Conflict"
    room.opened()
    room.drive(3)
    assert room.status().barrier == BARRIER_PHASE_RUNNING
    assert [arm.measured for arm in room.newest.arms] == [True, True]
    assert all(arm.measured_age_s <= 0.02 for arm in room.newest.arms)


@pytest.mark.parametrize("fault", ["It is hot.", "silence"])
def test_one_driver_in_trouble_stops_all_arms_and_is_told_by_name(room: DrivenRoom, fault: str) -> None:
    room.opened()
    room.drive(3)
    begun = len(room.drivers.told)
    if fault == "silence":
        room.drivers.silent.add("arm1")
    else:
        room.drivers.fault = fault
    room.pass_time(0.13)
    stop = room.status().stop
    assert stop.name.startswith("Driver of arm")
    assert stop.name.endswith("(OurArm)")
    assert ("silent" if fault == "silence" else fault) in stop.fault
    last = {target.arm: target for target in room.drivers.told[begun:]}
    assert {arm: target.stop for arm, target in last.items()} == {"arm0": True, "arm1": True}
    assert any(text.startswith("Driver of arm1 (OurArm) stopped everything: ") for text in room.texts())
    assert room.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == "Conflict"
    room.drivers.silent.clear()
    room.drivers.fault = ""
    room.pass_time(0.05)
    assert room.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == ""


def test_a_fault_beside_another_stop_is_told_too(room: DrivenRoom) -> None:
    room.opened()
    room.drive(2)
    assert room.ask(EpisodeRequest(stop=EpisodeRequest.Stop(name="Ben"))) == ""
    room.drivers.fault = "It is hot."
    room.pass_time(0.1)
    assert room.status().stop.name == "Ben"
    assert sum("It is hot." in text for text in room.texts()) == 2  # once for each arm


def test_troubles_that_come_and_go_are_told_once_until_the_arm_is_well(room: DrivenRoom) -> None:
    room.opened()
    room.drive(2)
    for _ in range(3):
        for fault in ("It is hot.", "It is cold."):
            room.drivers.fault = fault
            room.pass_time(0.1)
    told = [text for text in room.texts() if "It is" in text]
    assert len(told) == len(set(told)) == 4
    room.drivers.fault = ""
    room.pass_time(0.1)
    room.drivers.fault = "It is hot."
    room.pass_time(0.1)
    assert len([text for text in room.texts() if "It is" in text]) == 6


def test_what_nobody_could_hear_is_no_silence(room: DrivenRoom) -> None:
    room.opened()
    room.drive(2)
    room.now_s += 1.0  # this process stood still
    room.room.advance(room.now_s)
    assert not room.status().HasField("stop")


def test_targets_go_out_at_every_tick_and_again_while_none_fires(room: DrivenRoom) -> None:
    room.opened()
    room.drive(2)
    begun = len(room.drivers.told)
    room.drive(1, x_m=0.02)
    moved = [target for target in room.drivers.told[begun:] if target.arm == "arm0"]
    tool = room.world.tool_pose_in_base("arm0").position
    assert moved[-1].target_tool_in_base.x == pytest.approx(tool[0] + 0.02, abs=2e-3)
    assert moved[-1].tick == room.newest.tick
    room.pass_time(0.2)  # nobody commands
    repeated = [target for target in room.drivers.told[begun:] if target.arm == "arm0"]
    assert len(repeated) - len(moved) >= 3
    assert [t.sequence for t in room.drivers.told] == sorted(t.sequence for t in room.drivers.told)


def test_observations_and_the_twin_are_what_was_measured(room: DrivenRoom) -> None:
    room.opened()
    room.drive(2)
    joints = [0.1, 0.3, -0.1, -2.0, 0.1, 2.2, 0.7]
    for _ in range(6):
        for arm in ("arm0", "arm1"):
            room.command(arm)
        room.drivers.measure(room.now_s, joints, DRIVER_PHASE_FOLLOWING)
        RoomHarness.pass_time(room, 0.05)
    seen = {one.name: list(one.value) for one in room.newest.observations}
    assert seen["arm0/joint_positions"] == pytest.approx(joints)
    assert seen["arm1/joint_positions"] == pytest.approx(joints)


def test_a_reset_leaves_real_arms_where_they_are_and_tells_them_to_stand(room: DrivenRoom) -> None:
    room.opened()
    room.drive(2)
    room.drivers.told.clear()
    assert room.ask(EpisodeRequest(reset=EpisodeRequest.Reset(holder_id="arm0"))) == ""
    tool = room.world.tool_pose_in_base("arm0").position
    (first,) = [target for target in room.drivers.told if target.arm == "arm0"][:1]
    assert first.target_tool_in_base.x == pytest.approx(tool[0])
    room.drive(1)
    seen = {one.name: list(one.value) for one in room.newest.observations}
    assert seen["arm0/joint_positions"] == pytest.approx(HOME_RAD, abs=1e-9)


def test_a_room_may_be_mixed(compiled: World) -> None:
    room = DrivenRoom(compiled, ("arm1",))
    room.opened()
    room.drive(1)
    begun = room.newest.arms[0].tool_in_base.x
    room.drive(10, x_m=0.02)
    assert [arm.measured for arm in room.newest.arms] == [False, True]
    seen = {one.name: np.array(one.value) for one in room.newest.observations}
    assert seen["arm1/joint_positions"] == pytest.approx(HOME_RAD)
    assert room.newest.arms[0].tool_in_base.x - begun > 0.01


def test_a_clutch_that_is_held_through_a_stop_moves_nothing(room: DrivenRoom) -> None:
    room.opened()
    room.drive(3)  # engaged from the first command on: nobody let go since the room stood
    assert not any(target.engaged for target in room.drivers.told)


def test_a_clutch_counts_once_it_was_let_go_of_since_the_stop() -> None:
    clutch = Clutch()
    assert not clutch.engages(True, machine=False, now_s=0.0)
    assert not clutch.engages(False, machine=False, now_s=1.0)
    assert clutch.engages(True, machine=False, now_s=2.0)
    clutch.stopped()
    assert not clutch.engages(True, machine=False, now_s=3.0)


def test_a_machine_is_engaged_by_the_people_who_let_the_stop_go() -> None:
    clutch = Clutch()
    assert not clutch.engages(True, machine=True, now_s=0.0)
    assert not clutch.engages(True, machine=True, now_s=0.4)
    assert clutch.engages(True, machine=True, now_s=0.6)


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ({"kind": "ur5e"}, "The driver OurArm is of a ur5e with 7 joints; arm0 of room-1 is a panda with 7."),
        ({"joints": 6}, "The driver OurArm is of a panda with 6 joints; arm0 of room-1 is a panda with 7."),
        ({"model_sha256": "n"}, "The driver OurArm computes by another model than room-1 has"),
        ({"wire_version": DRIVER_WIRE_VERSION + 1}, "install the same version of MART on both machines."),
    ],
)
def test_a_driver_of_another_arm_model_or_version_is_refused_in_a_sentence_and_the_room_stands(
    room: DrivenRoom, other: dict[str, object], said: str
) -> None:
    with pytest.raises(InvalidInput) as refused:
        room.drivers.arms.hello(hello(other=other), room.now_s)
    assert said in str(refused.value)
    room.pass_time(0.3)
    assert room.status().stop.fault.startswith("No driver has connected")
    assert room.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == "Conflict"


def test_a_room_that_stutters_hears_of_a_silent_driver_all_the_same() -> None:
    drivers = Drivers()
    drivers.arms.begin(1, 0.0)
    drivers.connect(0.0)
    drivers.measure(0.0)
    looks = [(0.08 * look, drivers.arms.troubles(0.08 * look)) for look in range(1, 10)]
    first_s = next(at_s for at_s, troubles in looks if troubles)
    assert first_s <= 0.3


def test_an_arm_that_is_simulated_has_no_driver() -> None:
    with pytest.raises(NotFound):
        Drivers().arms.hello(hello("arm1"), 0.0)


def test_an_arm_has_one_driver_until_that_falls_silent() -> None:
    drivers = Drivers()
    drivers.connect(0.0)
    with pytest.raises(Conflict):
        drivers.arms.hello(hello(instance="b"), 0.5)
    again = drivers.arms.hello(hello(instance="arm0"), 0.6)  # the same one, whose answer was lost
    assert again.session == 2
    assert drivers.arms.hello(hello(instance="b"), 2.0).session == 3
    drivers.measure(2.1)  # what the old one still says
    assert drivers.arms.rejected["of no session"] == 1


@pytest.mark.parametrize(
    "wrong",
    [
        {"joint_positions": [0.0] * 6},
        {"joint_positions": [*HOME_RAD[:6], float("nan")]},
        {"gripper": 2.0},
        {"gripper": float("nan")},
        {"age_s": -1.0},
        {"age_s": float("nan")},
        {"sequence": 0},
    ],
)
def test_what_is_no_reading_of_the_arm_is_counted_and_left(wrong: dict[str, object]) -> None:
    drivers = Drivers()
    drivers.connect(0.0)
    drivers.measure(0.1)
    said = {"session": 1, "sequence": 99, "joint_positions": HOME_RAD} | wrong
    drivers.arms.hear(ArmMeasured(arm="arm0", **said), 0.2)  # type: ignore[arg-type]
    assert drivers.arms.rejected.total() == 1
