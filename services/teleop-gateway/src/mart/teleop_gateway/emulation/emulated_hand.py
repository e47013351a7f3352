"""Move an emulated phone as a hand would, so that the tool goes where an expert wants it. Pure.

It is the inverse of `retarget`, with a person's manners: it presses the clutch while nothing moves, keeps still until
it is told that the clutch holds, and never moves faster than a hand does.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

import numpy as np

from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_multiply, rotate
from mart.teleop_gateway.input.retarget import conjugated, heading_rad, session_to_base

HAND_SPEED_M_PER_S = 1.5
HAND_TURN_RAD_PER_S = 8.0
_STILL_FOR_S = 0.15
_STILL_M = 5e-4
_STILL_RAD = 5e-3
_PATIENCE_S = 0.5  # for the word that the clutch holds


@dataclass(frozen=True)
class ToolIntent:
    """Tell where an expert wants the tool. `gripper` is 0 open … 1 closed."""

    pose_tool_in_base: Pose
    gripper: float
    engaged: bool


@dataclass(frozen=True)
class PhoneReading:
    """Tell what the emulated phone reports next. `gripper` is 0 open … 1 closed."""

    phone_in_session: Pose
    clutch: bool
    gripper: float


class _Phase(enum.Enum):
    OPEN = enum.auto()
    PRESSED = enum.auto()  # and waiting for the word that it holds
    MOVING = enum.auto()


def resting_pose(heading_rad: float, pitch_rad: float = math.radians(45)) -> Pose:
    """Return a phone held before a person: turned by `heading_rad` about the session's y axis, its top tilted back."""
    turn = np.array([math.cos(heading_rad / 2), 0.0, math.sin(heading_rad / 2), 0.0])
    tilt = np.array([math.cos(pitch_rad / 2), -math.sin(pitch_rad / 2), 0.0, 0.0])
    return Pose(np.zeros(3), quaternion_multiply(turn, tilt))


class EmulatedHand:
    """Move a phone so that the tool goes where an expert wants it."""

    def __init__(self, azimuth_rad: float, rest_in_session: Pose, scale: float = 1.0) -> None:
        """Hold the phone. `azimuth_rad`: the seat's camera's, in the arm's base frame; `scale`: the gateway's."""
        self._azimuth_rad = azimuth_rad
        self._scale = scale
        self._rest = rest_in_session
        self._phone = rest_in_session
        self._phase = _Phase.OPEN
        self._since_s = -math.inf
        self._tool_at_press: Pose | None = None
        self._phone_at_press = rest_in_session
        self._measured: Pose | None = None
        self._moved_s = -math.inf
        self._gripper = 0.0

    def see(self, measured_tool_in_base: Pose, now_s: float) -> None:
        """Take where the arm's tool is now."""
        if self._measured is not None:
            metres, radians = measured_tool_in_base.distance_to(self._measured)
            if metres < _STILL_M and radians < _STILL_RAD:
                return
        self._measured = measured_tool_in_base
        self._moved_s = now_s

    def world_was_reset(self, now_s: float) -> None:
        """Let go: what the hand held on to is not there any more."""
        self._enter(_Phase.OPEN, now_s)

    def move(
        self, intent: ToolIntent | None, clutch_holds: bool, now_s: float, elapsed_s: float
    ) -> PhoneReading:
        """Return the phone after `elapsed_s`. `clutch_holds` is what the gateway told last."""
        if intent is not None:
            self._gripper = intent.gripper
        wanted = intent is not None and intent.engaged
        self._change_phase(wanted, clutch_holds, now_s)
        goal = self._rest
        if self._phase is _Phase.PRESSED:
            goal = self._phone
        elif self._phase is _Phase.MOVING and intent is not None:
            goal = self._phone_for(intent.pose_tool_in_base)
        self._phone = _towards(self._phone, goal, elapsed_s)
        return PhoneReading(self._phone, self._phase is not _Phase.OPEN, self._gripper)

    def _change_phase(self, wanted: bool, clutch_holds: bool, now_s: float) -> None:
        lasted_s = now_s - self._since_s
        if not wanted and self._phase is not _Phase.OPEN:
            self._enter(_Phase.OPEN, now_s)
        elif self._phase is _Phase.OPEN and wanted and self._may_press(now_s):
            self._tool_at_press, self._phone_at_press = self._measured, self._phone
            self._enter(_Phase.PRESSED, now_s)
        elif self._phase is _Phase.PRESSED and clutch_holds:
            self._enter(_Phase.MOVING, now_s)
        elif self._phase is not _Phase.OPEN and not clutch_holds and lasted_s > _PATIENCE_S:
            self._enter(_Phase.OPEN, now_s)  # the validator made it let go: press anew

    def _may_press(self, now_s: float) -> bool:
        moved = self._phone.distance_to(self._rest)
        settled = moved[0] < _STILL_M and moved[1] < _STILL_RAD
        still_s = now_s - max(self._moved_s, self._since_s)
        return self._measured is not None and settled and still_s > _STILL_FOR_S

    def _enter(self, phase: _Phase, now_s: float) -> None:
        self._phase, self._since_s = phase, now_s

    def _phone_for(self, tool_in_base: Pose) -> Pose:
        assert self._tool_at_press is not None
        tool, phone = self._tool_at_press, self._phone_at_press
        back = quaternion_conjugate(session_to_base(heading_rad(phone), self._azimuth_rad))
        shift = (tool_in_base.position - tool.position) / self._scale
        turn = quaternion_multiply(tool_in_base.quaternion_wxyz, quaternion_conjugate(tool.quaternion_wxyz))
        return Pose(
            phone.position + rotate(back, shift),
            quaternion_multiply(conjugated(back, turn), phone.quaternion_wxyz),
        )


def _towards(start: Pose, goal: Pose, elapsed_s: float) -> Pose:
    """Return the pose that a hand gets to on the way in `elapsed_s`."""
    metres, radians = goal.distance_to(start)
    part = min(
        1.0,
        HAND_SPEED_M_PER_S * elapsed_s / max(metres, 1e-12),
        HAND_TURN_RAD_PER_S * elapsed_s / max(radians, 1e-12),
    )
    if part == 1.0:
        return goal
    turn = Pose(np.zeros(3), goal.quaternion_wxyz) @ Pose(np.zeros(3), start.quaternion_wxyz).inverse()
    step = Pose.exp(part * turn.log())
    position = start.position + part * (goal.position - start.position)
    return Pose(position, quaternion_multiply(step.quaternion_wxyz, start.quaternion_wxyz))
