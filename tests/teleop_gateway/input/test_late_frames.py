"""What a link held back moves nothing when it comes at last."""

from __future__ import annotations

from typing import Any

import pytest

from mart.protocol.messages import ArmState
from mart.teleop_gateway.input.driving import InputDevice
from mart.teleop_gateway.input.frame_validator import LetGo
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.tool_motion import ToolMotion
from tests.teleop_gateway.input.strategies import phone_frame
from tests.teleop_gateway.input.test_driving import FRAME_S, HOME, NOW_NS, Seat, target


@pytest.fixture
def seat() -> Seat:
    seat = Seat()
    seat.driving.connect(InputDevice.KEYBOARD)
    return seat


def test_what_waited_through_an_outage_moves_and_grips_nothing(seat: Seat) -> None:
    """Pressed anew and moved while the link was broken: all of it comes at its end, and none of it counts."""
    source = InputDevice.KEYBOARD
    for _ in range(60):
        seat.command()
    assert seat.command(clutch=True, gripper=0.2).engaged
    broke_s = seat.now_s
    seat.driving.picture.on_displayed(0, broke_s)
    seat.driving.see(ArmState(arm="arm0", gripper=0.2, action=[0.0] * 6 + [-0.6]), 9, 1.0, broke_s)
    hands: list[dict[str, Any]] = [
        {"clutch": number > 20, "position": (0.0, 0.004 * number, 0.0)} for number in range(50)
    ]
    for number, hand in enumerate(hands):
        seat.numbers[source] += 1
        sent_us = int((broke_s + number * FRAME_S) * 1e6)
        frame = phone_frame(
            seat.numbers[source], sent_us=sent_us, gripper=0.9, more=Flag.SCREEN_ALIGNED, **hand
        )
        command = seat.driving.receive(source, frame.encode(), ToolMotion(HOME), broke_s + 3.0, NOW_NS)
        assert command is not None
        assert not command.engaged
        assert command.gripper == pytest.approx(0.2)
        assert target(command).distance_to(HOME)[0] < 1e-9
    seat.now_s = broke_s + 3.0
    seat.driving.picture.on_displayed(9, seat.now_s)
    assert not seat.command(clutch=True).engaged  # held since before anything new came
    assert seat.driving.let_go(seat.now_s) in (LetGo.GAP, LetGo.AGE)
    seat.command()
    assert seat.command(clutch=True).engaged


def test_an_emergency_stop_counts_however_late_it_comes(seat: Seat) -> None:
    for _ in range(60):
        seat.command()
    seat.now_s += 3.0
    seat.numbers[InputDevice.KEYBOARD] += 1
    late = phone_frame(
        seat.numbers[InputDevice.KEYBOARD], sent_us=int((seat.now_s - 2.5) * 1e6), more=Flag.EMERGENCY_STOP
    )
    command = seat.driving.receive(InputDevice.KEYBOARD, late.encode(), ToolMotion(HOME), seat.now_s, NOW_NS)
    assert command is not None
    assert command.emergency_stop
