"""Turn a hand's motion into a tool's: what the person sees move is what they moved.

Frames: the phone reports its pose in a session frame (x right, y up, z towards the person) whose heading is arbitrary;
the arm wants targets in its base frame (x forward, y left, z up); the person watches through the seat's camera. So the
phone's heading at the press of the clutch is laid onto the camera's azimuth. Up stays up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_multiply, rotate
from mart.teleop_gateway.input.frame_validator import HandSample
from mart.teleop_gateway.input.phone_frame import Flag
from mart.teleop_gateway.input.tool_motion import Stopping, ToolMotion

Array = NDArray[np.float64]

# Forward and up in equal parts: its horizontal part points ahead for a camera or phone held anywhere from upright to
# flat, where either axis alone would vanish.
_AHEAD = np.array([0.0, 1.0, -1.0])
# Turns (right, up, towards the person) into (forward, left, up): x → -y, y → z, z → -x.
_SESSION_TO_LEVEL = np.array([0.5, 0.5, -0.5, -0.5])
_TINY = 1e-9


@dataclass(frozen=True)
class ArmTarget:
    """Tell what the arm is asked to do. `gripper` is 0 open … 1 closed."""

    pose_tool_in_base: Pose
    gripper: float
    engaged: bool


@dataclass(frozen=True)
class _ClutchReference:
    """Hold what was where at the press, and how motions turn from session to base (quaternions wxyz)."""

    phone_in_session: Pose
    tool_in_base: Pose
    position_turn: Array
    orientation_turn: Array


class Retarget:
    """Let one hand lead one arm. `azimuth_rad` is where the seat's camera looks, see `azimuth_of_camera_rad`.

    `scale`: metres of tool for each metre of hand; rotations are never scaled.
    """

    def __init__(self, azimuth_rad: float, scale: float = 1.0) -> None:
        self.scale = scale
        self._azimuth_rad = azimuth_rad
        self._grip: _ClutchReference | None = None
        self._stopping: Stopping | None = None

    def follow(self, hand: HandSample, tool: ToolMotion) -> ArmTarget:
        """Return the target after this frame.

        A press takes both poses as references and asks for the pose in which the tool comes to rest: nothing moves. An
        open clutch stops the tool where it is, plus its stopping distance, and holds it there.
        """
        if not hand.clutch:
            self._grip = None
            self._stopping = self._stopping or Stopping(tool)
            return ArmTarget(self._stopping.see(tool), hand.frame.gripper, engaged=False)
        self._stopping = None
        if self._grip is None:
            self._grip = self._take(hand, tool.stopping_pose())
        return ArmTarget(
            self._moved(self._grip, hand.pose_phone_in_session), hand.frame.gripper, engaged=True
        )

    def release(self) -> None:
        """Let another hand take over: the tool stops, and a held clutch takes its references anew."""
        self._grip = None

    def forget(self) -> None:
        """Do as `release` and forget where the tool was to stop: the world was reset, and it means nothing now."""
        self._grip = None
        self._stopping = None

    def _take(self, hand: HandSample, tool_in_base: Pose) -> _ClutchReference:
        flags = hand.frame.flags
        aligned = session_to_base(0.0, self._azimuth_rad)
        turned = session_to_base(heading_rad(hand.pose_phone_in_session), self._azimuth_rad)
        return _ClutchReference(
            hand.pose_phone_in_session,
            tool_in_base,
            position_turn=aligned if flags & (Flag.SCREEN_ALIGNED | Flag.ORIENTATION_ONLY) else turned,
            orientation_turn=aligned if Flag.SCREEN_ALIGNED in flags else turned,
        )

    def _moved(self, grip: _ClutchReference, phone_in_session: Pose) -> Pose:
        before = grip.phone_in_session
        shift = self.scale * (phone_in_session.position - before.position)
        turn = quaternion_multiply(
            phone_in_session.quaternion_wxyz, quaternion_conjugate(before.quaternion_wxyz)
        )
        return Pose(
            grip.tool_in_base.position + rotate(grip.position_turn, shift),
            quaternion_multiply(conjugated(grip.orientation_turn, turn), grip.tool_in_base.quaternion_wxyz),
        )


def heading_rad(phone_in_session: Pose) -> float:
    """Return where a held phone points, about the session's y axis; 0 is along -z, away from the person.

    Zero where it points straight up or down.
    """
    x, _, z = rotate(phone_in_session.quaternion_wxyz, _AHEAD)
    return math.atan2(-x, -z) if math.hypot(x, z) > _TINY else 0.0


def azimuth_of_camera_rad(camera_in_base: Pose) -> float:
    """Return where a camera (OpenGL axes) looks, about the z axis of the base frame; 0 is along x."""
    x, y, _ = rotate(camera_in_base.quaternion_wxyz, _AHEAD)
    return math.atan2(y, x) if math.hypot(x, y) > _TINY else 0.0


def session_to_base(heading_rad: float, azimuth_rad: float) -> Array:
    """Return the rotation, quaternion wxyz, that lays a heading in the session onto an azimuth in the base frame."""
    back = np.array([math.cos(heading_rad / 2), 0.0, -math.sin(heading_rad / 2), 0.0])
    ahead = np.array([math.cos(azimuth_rad / 2), 0.0, 0.0, math.sin(azimuth_rad / 2)])
    return quaternion_multiply(ahead, quaternion_multiply(_SESSION_TO_LEVEL, back))


def conjugated(turn: Array, rotation: Array) -> Array:
    """Return `rotation`, quaternion wxyz, as seen from the frame that `turn` leads to."""
    return quaternion_multiply(turn, quaternion_multiply(rotation, quaternion_conjugate(turn)))
