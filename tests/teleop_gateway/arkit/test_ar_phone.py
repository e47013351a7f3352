"""What the app says becomes frames: the button is the clutch, a tap on the toggle closes or opens."""

from __future__ import annotations

import numpy as np
import pytest

from mart.teleop_gateway.arkit.ar_message import ARSample, parse_sample
from mart.teleop_gateway.arkit.ar_phone import STALE_S, ARPhone
from mart.teleop_gateway.input.phone_frame import Flag, PhoneFrame
from tests.teleop_gateway.arkit.ar_app import app_message, camera_at

NOW_S = 100.0
KNOWN = Flag.TRACKING | Flag.SCREEN_ALIGNED


def sample(*, button: bool = False, toggle: bool = False) -> ARSample:
    return parse_sample(app_message(camera_at((0.1, 0.2, 0.3)), button=button, toggle=toggle))


def sent(phone: ARPhone, seen: ARSample | None, age_s: float = 0.01) -> PhoneFrame:
    return phone.frame(seen, NOW_S - age_s, NOW_S, 7)


def test_the_button_is_the_clutch() -> None:
    phone = ARPhone(seat_epoch=3)
    frames = [sent(phone, sample()), sent(phone, sample(button=True))]
    assert [frame.flags for frame in frames] == [KNOWN, KNOWN | Flag.CLUTCH]
    assert [frame.sequence for frame in frames] == [1, 2]
    assert frames[0].position == (0.1, 0.2, 0.3)
    assert frames[0].seat_epoch == 3


def test_a_silent_app_is_a_phone_that_does_not_know_where_it_is() -> None:
    phone = ARPhone(seat_epoch=3)
    assert Flag.TRACKING not in sent(phone, sample(button=True), age_s=STALE_S + 0.01).flags
    assert sent(phone, None).flags == Flag.SCREEN_ALIGNED


def test_each_tap_on_the_toggle_closes_or_opens() -> None:
    phone = ARPhone(seat_epoch=3)
    taps = [True, True, False, False, True]  # it was on when the phone came, which says nothing
    assert [sent(phone, sample(toggle=toggle)).gripper for toggle in taps] == [0.0, 0.0, 1.0, 1.0, 0.0]


def test_the_gripper_is_where_others_left_it() -> None:
    phone = ARPhone(seat_epoch=3)
    phone.on_told({"tick": 5, "gripper": 0.4, "gripper_set": 1, "input": "phone"})
    assert sent(phone, sample()).gripper == 1.0
    assert sent(phone, sample(toggle=True)).gripper == 0.0
    phone.on_told({"tick": 6, "gripper": 0.4, "gripper_set": 1, "input": "phone"})  # it has not opened yet
    frame = sent(phone, sample(toggle=True))
    assert (frame.gripper, frame.seen_tick) == (0.0, 6)
    phone.on_told({"tick": 7, "gripper": 0.9, "gripper_set": 1, "input": "keyboard"})
    assert sent(phone, sample(toggle=True)).gripper == 1.0


@pytest.mark.parametrize("pitch_rad", [-1.2, 0.0, 0.6, 1.5])
def test_ahead_is_where_the_person_looks_at_the_press_however_the_phone_is_held(pitch_rad: float) -> None:
    """Started flat or upright; then the person turned by 1.1 rad, and pressed."""
    phone, began = ARPhone(seat_epoch=3), camera_at((0, 0, 0), pitch_rad=0.3)
    ahead = np.array((-np.sin(1.1), 0.0, -np.cos(1.1)))

    def frame(forward_m: float, *, button: bool) -> PhoneFrame:
        x, y, z = forward_m * ahead
        turned = camera_at((x, y, z), yaw_rad=1.1, pitch_rad=0.3 + pitch_rad)
        return sent(phone, parse_sample(app_message(turned, began=began, button=button)))

    frame(0.0, button=False)
    pressed, moved = frame(0.0, button=True), frame(0.2, button=True)
    np.testing.assert_allclose(np.subtract(moved.position, pressed.position), (0, 0, -0.2), atol=1e-9)


def test_turning_while_the_button_is_held_turns_no_axes() -> None:
    phone = ARPhone(seat_epoch=3)
    sent(phone, parse_sample(app_message(camera_at((0, 0, 0)))))
    for yaw_rad in (0.2, 0.4):
        turned = camera_at((0.1, 0, 0), yaw_rad=yaw_rad)
        frame = sent(phone, parse_sample(app_message(turned, button=True)))
        np.testing.assert_allclose(frame.position, (0.1, 0, 0), atol=1e-9)


def test_a_phone_that_comes_anew_taps_nothing() -> None:
    phone = ARPhone(seat_epoch=3)
    frames = [sent(phone, one) for one in (sample(toggle=True), None, sample(toggle=False))]
    assert [frame.gripper for frame in frames] == [0.0, 0.0, 0.0]
