"""Turn what the app MuJoCo AR says into phone frames. Pure: samples, status messages and `now_s` in, frames out."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mart.protocol.pose import Pose, quaternion_multiply, rotate
from mart.teleop_gateway.arkit.ar_message import ARSample
from mart.teleop_gateway.input.phone_frame import Flag, PhoneFrame

STALE_S = 0.2  # the app speaks up to 60 times a second, over Wi-Fi
_CLOSED_ABOVE = 0.15  # a gripper that holds something is neither open nor shut
_AT_REST = Pose(np.zeros(3), np.array((1.0, 0.0, 0.0, 0.0)))
_TINY = 1e-6


class ARPhone:
    """Hold the phone that drives: while the button is held the arm follows, and each toggle closes or opens.

    seat_epoch: of the seat's present holder.
    """

    def __init__(self, seat_epoch: int) -> None:
        self.seat_epoch = seat_epoch
        self._told: dict[str, Any] = {}
        self._gripper = 0.0
        self._toggle: bool | None = None  # as it was last; None: unknown
        self._sequence = 0
        self._yaw_rad = 0.0  # how far the person has turned since the app was started, at the press

    def on_told(self, tick: dict[str, Any]) -> None:
        """Take a status message: the gripper may have been set by somebody else."""
        is_set = self._told.get("gripper_set") != tick.get("gripper_set")
        if is_set or tick.get("input") != "phone":
            self._gripper = 1.0 if float(tick.get("gripper") or 0.0) > _CLOSED_ABOVE else 0.0
        self._told = tick

    def frame(self, sample: ARSample | None, heard_s: float, now_s: float, sent_us: int) -> PhoneFrame:
        """Return the next frame. `sample` came at `heard_s`; None: there is no phone."""
        flags, pose = Flag.SCREEN_ALIGNED, _AT_REST
        if sample is None:
            self._toggle = None
        else:
            flags |= Flag.TRACKING if now_s - heard_s < STALE_S else Flag(0)
            flags |= Flag.CLUTCH if sample.button else Flag(0)
            pose = self._aligned(sample)
            self._tap(sample.toggle)
        self._sequence += 1
        x, y, z = pose.position.tolist()
        qw, qx, qy, qz = pose.quaternion_wxyz.tolist()
        seen = int(self._told.get("tick", 0))
        return PhoneFrame(
            self.seat_epoch, self._sequence, seen, sent_us, (x, y, z), (qw, qx, qy, qz), self._gripper, flags
        )

    def _aligned(self, sample: ARSample) -> Pose:
        """Return the pose with z towards a person who looks at the screen: where they turned the phone to by the press.

        The app's orientation says nothing of how the phone is held, only how it was turned since the start: the
        gateway could not tell its heading from tilting.
        """
        w, _, y, _ = sample.pose_phone_in_session.quaternion_wxyz
        if not sample.button and math.hypot(w, y) > _TINY:
            self._yaw_rad = 2.0 * math.atan2(y, w)
        back = np.array((math.cos(self._yaw_rad / 2), 0.0, -math.sin(self._yaw_rad / 2), 0.0))
        phone = sample.pose_phone_in_session
        return Pose(rotate(back, phone.position), quaternion_multiply(back, phone.quaternion_wxyz))

    def _tap(self, toggle: bool) -> None:
        if self._toggle is not None and toggle != self._toggle:
            self._gripper = 1.0 - self._gripper
        self._toggle = toggle
