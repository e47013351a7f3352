"""An arm is led within limits, holds where nobody leads it, and a stop is latched until the clutch is pressed anew."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.driver import Measured
from mart.driver.limits import MotionLimits
from mart.driver.simulated.hardware import HardwareFault
from mart.protocol.messages import DRIVER_PHASE_FOLLOWING, DRIVER_PHASE_HOLDING, DRIVER_PHASE_STOPPED
from mart.protocol.pose import Pose
from tests.driver.led_arm import PERIOD_S, LedArm

_NOISE_RAD = 2e-4  # what still counts as standing: noise, and the last bit of a lag
_STOPS_WITHIN_S = 0.3


@pytest.fixture
def arm() -> LedArm:
    return LedArm()


def led(arm: LedArm) -> LedArm:
    """An arm that is on its way."""
    arm.press_clutch()
    arm.lead((0.0, 0.20, 0.0))
    arm.pass_time(0.3)
    assert arm.step is not None
    assert arm.step.phase == DRIVER_PHASE_FOLLOWING
    return arm


def test_it_goes_where_it_is_led_and_arrives(arm: LedArm) -> None:
    led(arm)
    arm.pass_time(2.0)
    away_m, away_rad = arm.tool.distance_to(arm.target)
    assert away_m < 0.002
    assert away_rad < 0.01


def test_nothing_moves_before_the_clutch_was_pressed(arm: LedArm) -> None:
    arm.lead((0.0, 0.10, 0.0))
    arm.engaged = True  # held already when the driver began: nobody has pressed it
    arm.pass_time(1.0)
    assert arm.moved_since(0.0) < _NOISE_RAD
    assert arm.step is not None
    assert arm.step.phase == DRIVER_PHASE_HOLDING


def test_it_holds_where_it_is_when_no_target_comes_and_goes_on_with_the_next(arm: LedArm) -> None:
    led(arm)
    arm.speaks = False
    arm.pass_time(_STOPS_WITHIN_S)
    begun_s = arm.now_s
    arm.pass_time(0.3)
    assert arm.moved_since(begun_s) < _NOISE_RAD
    assert arm.step is not None
    assert arm.step.phase == DRIVER_PHASE_HOLDING
    arm.speaks = True
    arm.pass_time(2.0)
    assert arm.tool.distance_to(arm.target)[0] < 0.002


def test_a_room_that_is_lost_stops_it_until_the_room_has_stopped_and_the_clutch_is_pressed(
    arm: LedArm,
) -> None:
    led(arm)
    arm.speaks = False
    arm.pass_time(1.2)
    arm.speaks = True
    begun_s = arm.now_s
    arm.pass_time(0.5)  # the room is back, and holds the clutch; it has not heard of it
    assert arm.step is not None
    assert arm.step.phase == DRIVER_PHASE_STOPPED
    assert "not heard" in arm.step.fault
    assert arm.moved_since(begun_s) < _NOISE_RAD


@pytest.mark.parametrize(
    "fault", [HardwareFault.FAULT, HardwareFault.FREEZE, HardwareFault.NAN, HardwareFault.STALE]
)
def test_what_is_wrong_with_the_hardware_stops_it_in_time_and_is_latched(
    arm: LedArm, fault: HardwareFault
) -> None:
    led(arm)
    arm.hardware.fault = fault
    arm.pass_time(_STOPS_WITHIN_S)
    begun_s = arm.now_s
    arm.pass_time(0.3)
    assert arm.step is not None
    assert arm.step.phase == DRIVER_PHASE_STOPPED
    assert arm.step.fault.endswith(".")
    assert arm.moved_since(begun_s) < _NOISE_RAD
    arm.hardware.fault = HardwareFault.NONE
    arm.press_clutch()  # in a room that has not stopped yet
    assert arm.step.phase == DRIVER_PHASE_STOPPED
    arm.stop = True
    arm.pass_time(0.1)
    arm.stop = False
    arm.engaged = True  # held through the stop
    begun_s = arm.now_s
    arm.pass_time(0.5)
    assert arm.moved_since(begun_s) < _NOISE_RAD
    arm.press_clutch()
    arm.lead((0.0, 0.10, 0.0))
    arm.pass_time(1.0)
    assert arm.moved_since(begun_s) > 0.05


def test_a_stop_of_the_room_stops_it_and_the_clutch_is_to_be_pressed_anew(arm: LedArm) -> None:
    led(arm)
    arm.stop = True
    arm.pass_time(_STOPS_WITHIN_S)
    begun_s = arm.now_s
    arm.pass_time(0.2)
    arm.stop = False  # the clutch is still held
    arm.pass_time(1.0)
    assert arm.moved_since(begun_s) < _NOISE_RAD
    arm.press_clutch()
    arm.pass_time(1.0)
    assert arm.moved_since(begun_s) > 0.05


def test_an_arm_that_does_not_follow_is_blocked(arm: LedArm) -> None:
    led(arm)
    stuck = list(arm.hardware.joints)
    for _ in range(200):
        arm.pass_time(PERIOD_S)
        arm.hardware.joints[0] = stuck[0]
        if arm.step is not None and arm.step.phase == DRIVER_PHASE_STOPPED:
            break
    assert arm.step is not None
    assert "does not follow" in arm.step.fault


def test_a_load_beyond_the_limit_stops_it() -> None:
    arm = LedArm(MotionLimits(load=0.8))
    arm.pass_time(0.1)
    heavy = Measured(1e9, np.array(arm.hardware.joints), 0.0, load=0.9)
    step = arm.follower.advance(heavy, arm.now_s + PERIOD_S)
    assert step.phase == DRIVER_PHASE_STOPPED
    assert "0.90" in step.fault


def test_an_arm_whose_tool_is_elsewhere_than_the_model_has_it_is_another_one(arm: LedArm) -> None:
    elsewhere = Pose(arm.tool.position + np.array([0.0, 0.0, 0.12]), arm.tool.quaternion_wxyz)
    step = arm.follower.advance(Measured(1.0, np.array(arm.hardware.joints), 0.0, elsewhere), arm.now_s)
    assert step.phase == DRIVER_PHASE_STOPPED
    assert "0.12 m" in step.fault


def test_readings_of_another_number_of_joints_are_none(arm: LedArm) -> None:
    step = arm.follower.advance(Measured(1.0, np.zeros(7)), arm.now_s)
    assert step.phase == DRIVER_PHASE_STOPPED
    assert "7 joints" in step.fault


def test_clocks_may_differ_by_days_and_run_at_their_own_pace(arm: LedArm) -> None:
    led(arm)  # the hardware's clock is an hour or a day off, and 0.1 % fast
    arm.pass_time(1.0)
    assert arm.step is not None
    assert arm.step.phase == DRIVER_PHASE_FOLLOWING


def test_a_clock_that_is_set_back_by_minutes_stops_it_once_with_a_sentence(arm: LedArm) -> None:
    led(arm)
    arm.hardware._offset_s -= 180.0
    arm.pass_time(0.1)
    assert arm.step is not None
    assert arm.step.phase == DRIVER_PHASE_STOPPED
    assert arm.step.fault == "The stamps of readings went back by 180 s: the clock they are of was set."
    arm.stop = True
    arm.pass_time(0.1)
    arm.stop = False
    arm.press_clutch()
    assert arm.step.phase == DRIVER_PHASE_FOLLOWING


def test_joints_that_are_read_in_degrees_stop_it_with_a_sentence(arm: LedArm) -> None:
    arm.pass_time(0.1)
    step = arm.follower.advance(Measured(1e9, np.degrees(arm.hardware.joints)), arm.now_s + PERIOD_S)
    assert step.phase == DRIVER_PHASE_STOPPED
    assert step.fault == (
        "Joint 3 was read at 108.86 rad; the model has it between -3.10 and 3.10. Is it in degrees, or of other zeros?"
    )


_EVENTS = st.lists(
    st.one_of(
        st.tuples(st.just("lead"), st.tuples(*[st.floats(-0.5, 0.5)] * 3)),
        st.tuples(st.just("engaged"), st.booleans()),
        st.tuples(st.just("stop"), st.booleans()),
        st.tuples(st.just("speaks"), st.booleans()),
        st.tuples(st.just("fault"), st.sampled_from(HardwareFault)),
        st.tuples(st.just("wait"), st.sampled_from([0.05, 0.3, 1.2])),
    ),
    max_size=25,
)


@settings(max_examples=25)
@given(events=_EVENTS)
def test_whatever_happens_it_stays_within_its_limits_and_moves_for_a_pressed_clutch_alone(
    events: list[tuple[str, object]],
) -> None:
    arm = LedArm()
    for what, value in [*events, ("wait", 0.3)]:
        if what == "lead":
            arm.lead(value)  # type: ignore[arg-type]
        elif what == "fault":
            arm.hardware.fault = HardwareFault(str(value))
        elif what != "wait":
            setattr(arm, what, value)
        arm.pass_time(value if what == "wait" else 0.05)  # type: ignore[arg-type]
    assert not [
        joints
        for joints, allowed in zip(arm.sent, arm.allowed, strict=True)
        if joints is not None and not allowed
    ]
    for before, after in zip(arm.sent, arm.sent[1:], strict=False):
        if before is None or after is None:
            continue
        assert np.abs(after - before).max() <= arm.limits.joint_speed_rad_s * PERIOD_S + 1e-9
        assert (after >= arm.kinematics.lowest).all()
        assert (after <= arm.kinematics.highest).all()
        moved_m, moved_rad = arm.kinematics.tool_in_base(before).distance_to(
            arm.kinematics.tool_in_base(after)
        )
        assert moved_m <= 1.5 * arm.limits.tool_speed_m_s * PERIOD_S  # what the last step left is made up for
        assert moved_rad <= 1.5 * arm.limits.tool_speed_rad_s * PERIOD_S + 1e-6
