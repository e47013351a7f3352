"""Which input drives, what becomes a command, and when an operator counts as lost."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mart.protocol.messages import OPERATOR_HUMAN, ArmState, Command, pose_from_message
from mart.protocol.pose import Pose
from mart.teleop_gateway.input.driving import LOST_AFTER_S, Driving, InputDevice
from mart.teleop_gateway.input.frame_validator import LetGo
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.retarget import Retarget
from mart.teleop_gateway.input.tool_motion import ToolMotion
from tests.teleop_gateway.input.strategies import NONE, phone_frame

EPOCH = 7
FIRST = 1_000_000
HOME = Pose(np.array([0.5, 0.0, 0.3]), np.array([0.0, 1.0, 0.0, 0.0]))
NOW_NS = 1_800_000_000_000_000_000
FRAME_S = 1 / 60


class Seat:
    """A driving with a clock and inputs that number their frames."""

    def __init__(self) -> None:
        self.driving = Driving("arm0", EPOCH, FIRST, Retarget(0.0))
        self.now_s = 50.0
        self.numbers = dict.fromkeys(InputDevice, 0)

    def send(self, source: InputDevice, *, measured: Pose | None = HOME, **given: Any) -> Command | None:
        self.now_s += FRAME_S
        self.numbers[source] += 1
        flags = given.pop("more", NONE) | Flag.SCREEN_ALIGNED
        frame = phone_frame(self.numbers[source], sent_us=int(self.now_s * 1e6), more=flags, **given)
        tool = None if measured is None else ToolMotion(measured, self.now_s)
        return self.driving.receive(source, frame.encode(), tool, self.now_s, NOW_NS)

    def command(self, source: InputDevice = InputDevice.KEYBOARD, **given: Any) -> Command:
        command = self.send(source, **given)
        assert command is not None
        return command


@pytest.fixture
def seat() -> Seat:
    seat = Seat()
    seat.driving.connect(InputDevice.KEYBOARD)
    return seat


def target(command: Command) -> Pose:
    return pose_from_message(command.target_tool_in_base)


def test_each_good_frame_is_one_command(seat: Seat) -> None:
    commands = [seat.command(gripper=0.5) for _ in range(5)]
    assert [command.sequence for command in commands] == list(range(FIRST, FIRST + 5))
    last = commands[-1]
    assert (last.arm, last.seat_epoch, last.source, last.gripper) == ("arm0", EPOCH, OPERATOR_HUMAN, 0.5)
    assert last.stamps.gateway_received_ns == NOW_NS
    assert not last.engaged
    assert target(last).distance_to(HOME) == (0, 0)


def test_a_held_clutch_moves_the_target(seat: Seat) -> None:
    seat.command()
    pressed = seat.command(clutch=True)
    assert pressed.engaged
    assert target(pressed).distance_to(HOME)[0] == 0
    moved = seat.command(clutch=True, position=(0.0, 0.05, 0.0))
    np.testing.assert_allclose(target(moved).position, HOME.position + np.array((0, 0, 0.05)), atol=1e-6)
    here = Pose(np.array([0.5, 0.0, 0.32]), HOME.quaternion_wxyz)
    released = seat.command(position=(0.0, 0.1, 0.0), measured=here)
    assert target(released).distance_to(here)[0] < 1e-9


def test_bad_frames_and_unseen_arms_give_no_command(seat: Seat) -> None:
    assert seat.send(InputDevice.KEYBOARD, epoch=8) is None
    assert seat.send(InputDevice.KEYBOARD, measured=None) is None
    assert seat.driving.receive(InputDevice.KEYBOARD, b"junk", ToolMotion(HOME), seat.now_s, NOW_NS) is None
    assert seat.driving.rejected() == {"epoch": 1, "malformed": 1}


def test_pairing_a_phone_makes_it_the_input(seat: Seat) -> None:
    seat.driving.connect(InputDevice.PHONE)
    assert seat.driving.active is InputDevice.PHONE
    assert seat.send(InputDevice.KEYBOARD) is None
    assert seat.send(InputDevice.PHONE) is not None


def test_a_phone_that_leaves_gives_the_arm_back(seat: Seat) -> None:
    seat.driving.connect(InputDevice.PHONE)
    seat.driving.disconnect(InputDevice.PHONE)
    assert seat.driving.active is InputDevice.KEYBOARD
    assert seat.send(InputDevice.KEYBOARD) is not None
    assert seat.driving.phone(seat.now_s) is None


def test_changing_hands_moves_nothing(seat: Seat) -> None:
    """Both clutches are held; what counts is where each hand was when it took over."""
    seat.command()
    seat.command(clutch=True)
    seat.command(clutch=True, position=(0.1, 0.0, 0.0))
    seat.driving.connect(InputDevice.PHONE)
    seat.command(InputDevice.PHONE, position=(0.4, 0.4, 0.4))
    here = Pose(np.array([0.5, 0.1, 0.3]), HOME.quaternion_wxyz)
    taken = seat.command(InputDevice.PHONE, clutch=True, position=(0.4, 0.4, 0.4), measured=here)
    assert target(taken).distance_to(here)[0] < 1e-9
    seat.driving.select(InputDevice.KEYBOARD)
    back = seat.command(clutch=True, position=(0.12, 0.0, 0.0), measured=here)
    assert target(back).distance_to(here)[0] < 1e-9


def test_a_new_peer_of_the_same_role_begins_anew(seat: Seat) -> None:
    for _ in range(10):
        seat.command()
    seat.driving.connect(InputDevice.KEYBOARD)
    seat.numbers[InputDevice.KEYBOARD] = 0
    command = seat.command(clutch=True)
    assert command.sequence == FIRST + 10
    assert not command.engaged  # held since before it came


def test_counts_outlive_the_peer(seat: Seat) -> None:
    seat.send(InputDevice.KEYBOARD, epoch=8)
    seat.driving.connect(InputDevice.KEYBOARD)
    seat.send(InputDevice.KEYBOARD, epoch=8)
    seat.driving.disconnect(InputDevice.KEYBOARD)
    assert seat.driving.rejected() == {"epoch": 2}


def test_silence_is_loss(seat: Seat) -> None:
    assert seat.driving.lost(seat.now_s)
    seat.command()
    seat.command(clutch=True)
    assert seat.driving.engaged(seat.now_s)
    assert not seat.driving.lost(seat.now_s + LOST_AFTER_S - 0.01)
    assert seat.driving.lost(seat.now_s + LOST_AFTER_S + 0.01)
    assert not seat.driving.engaged(seat.now_s + LOST_AFTER_S + 0.01)
    seat.now_s += LOST_AFTER_S + 0.01
    assert not seat.command(clutch=True).engaged


def test_a_reset_of_the_world_takes_references_anew(seat: Seat) -> None:
    seat.command()
    seat.command(clutch=True)
    seat.command(clutch=True, position=(0.05, 0.05, 0.05))
    seat.driving.world_was_reset()
    assert not seat.driving.engaged(seat.now_s)
    start = Pose(np.array([0.45, 0.05, 0.25]), HOME.quaternion_wxyz)
    command = seat.command(clutch=True, position=(0.05, 0.05, 0.05), measured=start)
    assert target(command).distance_to(start)[0] < 1e-9
    assert command.engaged


def test_the_emergency_stop_passes_without_a_clutch(seat: Seat) -> None:
    assert seat.command(more=Flag.EMERGENCY_STOP).emergency_stop
    assert not seat.command().emergency_stop


def test_the_input_stamp_is_on_the_gateways_clock(seat: Seat) -> None:
    assert seat.command().stamps.input_sent_ns == 0  # no offset told yet
    offset_ns = NOW_NS - int((seat.now_s + 2 * FRAME_S) * 1e9)
    seat.driving.set_clock(InputDevice.KEYBOARD, offset_ns)
    stamp_ns = seat.command().stamps.input_sent_ns
    assert NOW_NS - 50_000_000 < stamp_ns < NOW_NS
    seat.driving.set_clock(InputDevice.KEYBOARD, 10**30)
    assert seat.command().stamps.input_sent_ns == 0


def test_a_commands_frame_is_remembered_for_a_while(seat: Seat) -> None:
    for _ in range(600):
        seat.now_s += 0.01
        seat.command()
    assert seat.driving.frame_number(FIRST + 599) == 600
    assert seat.driving.frame_number(FIRST) is None
    assert seat.driving.frame_number(3) is None


def test_the_phones_state_is_told(seat: Seat) -> None:
    seat.driving.connect(InputDevice.PHONE)
    assert seat.driving.phone(seat.now_s) is None
    seat.command(InputDevice.PHONE, tracking=False)
    phone = seat.driving.phone(seat.now_s + 0.1)
    assert phone is not None
    assert phone.age_s == pytest.approx(0.1)
    assert not phone.tracking


def test_whoever_takes_over_drops_nothing_before_the_first_press_or_grip(seat: Seat) -> None:
    seat.driving.see(ArmState(arm="arm0", gripper=0.6, action=[0.0] * 6 + [1.0]), 1, 0.0, 50.0)
    assert seat.driving.gripper == 1.0  # what a page that comes now is told
    assert [seat.command(gripper=0.0).gripper for _ in range(3)] == [1.0, 1.0, 1.0]
    assert target(seat.command(gripper=0.0)).distance_to(HOME) == (0.0, 0.0)
    assert seat.command(gripper=0.0, more=Flag.CLUTCH).gripper == 0.0
    assert seat.command(gripper=0.0).gripper == 0.0


def test_a_grip_counts_also_with_an_open_clutch(seat: Seat) -> None:
    seat.driving.see(ArmState(arm="arm0", action=[0.0] * 6 + [1.0]), 1, 0.0, 50.0)
    assert [seat.command(gripper=given).gripper for given in (0.0, 0.0, 0.5, 0.5)] == [1.0, 1.0, 0.5, 0.5]


def test_a_phone_that_comes_drops_nothing_either(seat: Seat) -> None:
    seat.driving.see(ArmState(arm="arm0", gripper=0.0), 1, 0.0, 50.0)
    seat.command(gripper=0.0)
    seat.command(gripper=1.0)
    seat.driving.connect(InputDevice.PHONE)
    assert seat.command(InputDevice.PHONE, gripper=0.0).gripper == 1.0


def test_the_gripper_begins_open_at_every_reset_and_its_device_follows(seat: Seat) -> None:
    """Also where the clutch stays held; what the device says counts again once it says something new."""
    seat.command(gripper=1.0)
    assert seat.command(gripper=1.0, clutch=True).gripper == 1.0
    before = seat.driving.gripper_set
    seat.driving.see(ArmState(arm="arm0", gripper=0.9), 2, 0.0, 50.0)  # measured; the reset opens it
    seat.driving.world_was_reset()
    assert seat.driving.gripper_set == before + 1
    assert [seat.command(gripper=1.0, clutch=True).gripper for _ in range(3)] == [0.0, 0.0, 0.0]
    assert [seat.command(gripper=g, clutch=True).gripper for g in (0.0, 0.0, 1.0, 1.0)] == [
        0.0,
        0.0,
        1.0,
        1.0,
    ]


def test_the_device_that_takes_over_goes_on_with_the_gripper_as_it_is(seat: Seat) -> None:
    seat.driving.connect(InputDevice.PHONE)
    seat.command(InputDevice.PHONE, gripper=0.0)
    assert seat.command(InputDevice.PHONE, gripper=1.0).gripper == 1.0
    seat.driving.see(ArmState(arm="arm0", gripper=0.9, action=[0.0] * 6 + [1.0]), 2, 0.1, 50.0)
    before = seat.driving.gripper_set
    seat.driving.select(InputDevice.KEYBOARD)
    assert seat.driving.gripper_set == before + 1
    assert seat.command(gripper=0.0).gripper == 1.0


@pytest.mark.parametrize("reason", [LetGo.STOP, LetGo.PAUSE])
def test_a_room_that_stands_still_lets_go_of_every_clutch(seat: Seat, reason: LetGo) -> None:
    seat.command()
    assert seat.command(clutch=True).engaged
    seat.driving.held_by_room = reason
    assert not seat.command(clutch=True).engaged
    seat.driving.held_by_room = None
    assert not seat.command(clutch=True).engaged
    assert seat.driving.let_go(seat.now_s) is reason
    seat.command()
    assert seat.command(clutch=True).engaged


def test_a_command_tells_from_which_state_it_was_made(seat: Seat) -> None:
    assert seat.command().state_tick == 0
    seat.driving.see(ArmState(arm="arm0"), 41, 0.0, 50.0)
    assert seat.command().state_tick == 41
