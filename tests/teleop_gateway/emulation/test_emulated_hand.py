"""An emulated hand behind the real validator and retargeting leads the tool where the expert wants it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.protocol.pose import Pose, quaternion_exp
from mart.teleop_gateway.emulation.emulated_hand import (
    HAND_SPEED_M_PER_S,
    EmulatedHand,
    PhoneReading,
    ToolIntent,
    resting_pose,
)
from mart.teleop_gateway.input.frame_validator import FrameValidator
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.retarget import ArmTarget, Retarget
from mart.teleop_gateway.input.tool_motion import ToolMotion
from tests.teleop_gateway.input.strategies import NONE, angles_rad, phone_frame

FRAME_S = 1 / 60
HOME = Pose(np.array([0.5, 0.0, 0.3]), np.array([0.0, 1.0, 0.0, 0.0]))


class Loop:
    """Hand → frame → validator → retargeting → tool, with a tool that is where it is sent at once."""

    def __init__(self, azimuth_rad: float, heading_rad: float, scale: float = 1.0) -> None:
        self.hand = EmulatedHand(azimuth_rad, resting_pose(heading_rad), scale)
        self.validator = FrameValidator(7)
        self.retarget = Retarget(azimuth_rad, scale)
        self.tool = HOME
        self.engaged = False
        self.now_s = 10.0
        self.sequence = 0

    def step(
        self, intent: ToolIntent | None, *, more: Flag = Flag.TRACKING
    ) -> tuple[PhoneReading, ArmTarget]:
        self.now_s += FRAME_S
        self.sequence += 1
        self.hand.see(self.tool, self.now_s)
        held = self.hand.move(intent, self.engaged, self.now_s, FRAME_S)
        x, y, z = held.phone_in_session.position.tolist()
        qw, qx, qy, qz = held.phone_in_session.quaternion_wxyz.tolist()
        frame = phone_frame(
            self.sequence,
            sent_us=int(self.now_s * 1e6),
            position=(x, y, z),
            quaternion_wxyz=(qw, qx, qy, qz),
            gripper=held.gripper,
            clutch=held.clutch,
            tracking=Flag.TRACKING in more,
            more=NONE,
        )
        admitted = self.validator.validate(frame.encode(), self.now_s)
        assert admitted is not None, self.validator.rejected
        target = self.retarget.follow(admitted, ToolMotion(self.tool, self.now_s))
        self.tool, self.engaged = target.pose_tool_in_base, target.engaged
        return held, target

    def run(self, intent: ToolIntent | None, duration_s: float) -> None:
        for _ in range(int(duration_s / FRAME_S)):
            self.step(intent)


def wanted(shift: tuple[float, float, float], turn: tuple[float, float, float]) -> ToolIntent:
    pose = Pose(HOME.position + np.array(shift), HOME.quaternion_wxyz) @ Pose(
        np.zeros(3), quaternion_exp(np.array(turn))
    )
    return ToolIntent(pose, gripper=1.0, engaged=True)


shifts = st.tuples(*[st.floats(-0.3, 0.3)] * 3)
turns = st.tuples(*[st.floats(-0.6, 0.6)] * 3)


@settings(max_examples=25)
@given(shifts, turns, angles_rad, angles_rad, st.floats(0.5, 2.0))
def test_the_tool_arrives_whatever_the_headings(
    shift: tuple[float, float, float],
    turn: tuple[float, float, float],
    azimuth_rad: float,
    heading_rad: float,
    scale: float,
) -> None:
    loop = Loop(azimuth_rad, heading_rad, scale)
    intent = wanted(shift, turn)
    loop.run(intent, 1.5)
    metres, radians = loop.tool.distance_to(intent.pose_tool_in_base)
    assert metres < 1e-4  # frames carry 32 bit
    assert radians < 1e-3
    assert loop.validator.rejected == {}


def test_a_press_moves_nothing_and_nothing_is_pressed_while_the_arm_moves() -> None:
    loop = Loop(0.3, 0.7)
    intent = wanted((0.2, 0.0, 0.0), (0.0, 0.0, 0.0))
    for i in range(30):
        loop.tool = Pose(HOME.position + np.array((0.0, 0.0, 1e-3 * i)), HOME.quaternion_wxyz)
        held, _ = loop.step(intent)
        loop.retarget.forget()
        assert not held.clutch
    loop.tool = resting = HOME
    pressed = False
    while not pressed:
        held, target = loop.step(intent)
        pressed = held.clutch
        assert target.pose_tool_in_base.distance_to(resting)[0] < 1e-9


def test_it_moves_no_faster_than_a_hand() -> None:
    loop = Loop(0.0, 0.0)
    intent = wanted((0.3, 0.3, 0.3), (0.0, 0.0, 3.0))
    before = loop.step(intent)[0].phone_in_session
    for _ in range(100):
        phone = loop.step(intent)[0].phone_in_session
        assert phone.distance_to(before)[0] <= HAND_SPEED_M_PER_S * FRAME_S + 1e-9
        before = phone


def test_it_waits_for_the_word_that_the_clutch_holds() -> None:
    """Where the first pressed frame is lost, a hand that moved on would be led by the wrong reference."""
    loop = Loop(0.0, 0.0)
    intent = wanted((0.2, 0.0, 0.0), (0.0, 0.0, 0.0))
    while not loop.step(intent)[0].clutch:
        pass
    pressed_at = loop.hand.move(intent, False, loop.now_s, FRAME_S).phone_in_session
    later = loop.hand.move(intent, False, loop.now_s + 0.2, FRAME_S)
    assert later.clutch
    assert later.phone_in_session.distance_to(pressed_at)[0] == 0
    moved = loop.hand.move(intent, True, loop.now_s + 0.21, FRAME_S)
    assert moved.phone_in_session.distance_to(pressed_at)[0] > 0


def test_it_presses_anew_after_the_validator_made_it_let_go() -> None:
    loop = Loop(0.2, -0.4)
    intent = wanted((0.1, 0.1, 0.0), (0.0, 0.0, 0.0))
    loop.run(intent, 1.0)
    _, lost = loop.step(intent, more=NONE)  # tracking is lost for one frame
    assert not lost.engaged
    loop.run(intent, 2.0)
    assert loop.engaged
    assert loop.tool.distance_to(intent.pose_tool_in_base)[0] < 1e-4


@pytest.mark.parametrize(
    "again", [None, wanted((0.0, 0.1, 0.1), (0.0, 0.0, 0.0))], ids=["no intent", "a new intent"]
)
def test_after_a_reset_it_starts_over(again: ToolIntent | None) -> None:
    loop = Loop(0.2, -0.4)
    loop.run(wanted((0.1, 0.1, 0.0), (0.0, 0.0, 0.0)), 1.0)
    loop.hand.world_was_reset(loop.now_s)
    loop.retarget.forget()
    loop.tool = HOME
    held, target = loop.step(again)
    assert not held.clutch
    assert target.pose_tool_in_base.distance_to(HOME)[0] < 1e-9
    loop.run(again, 1.5)
    goal = again.pose_tool_in_base if again else HOME
    assert loop.tool.distance_to(goal)[0] < 1e-4
    assert loop.engaged == (again is not None)


def test_it_lets_go_when_the_expert_does_and_keeps_the_grip() -> None:
    loop = Loop(0.0, 0.0)
    intent = wanted((0.1, 0.0, 0.0), (0.0, 0.0, 0.0))
    loop.run(intent, 1.0)
    left = ToolIntent(intent.pose_tool_in_base, gripper=1.0, engaged=False)
    loop.run(left, 0.5)
    held, target = loop.step(None)
    assert not held.clutch
    assert held.gripper == target.gripper == 1.0
    assert target.pose_tool_in_base.distance_to(intent.pose_tool_in_base)[0] < 1e-4
    assert math.isclose(held.phone_in_session.distance_to(resting_pose(0.0))[0], 0.0, abs_tol=1e-6)
