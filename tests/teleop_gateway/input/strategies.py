"""What hypothesis draws: poses, quaternions, hands."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

from mart.protocol.pose import Pose, quaternion_exp
from mart.teleop_gateway.input.frame_validator import HandSample
from mart.teleop_gateway.input.phone_frame import Flag, PhoneFrame

NONE = Flag(0)

metres = st.floats(-1.0, 1.0)
angles_rad = st.floats(-math.pi, math.pi)
positions = st.tuples(metres, metres, metres)
# Rotation vectors short of π, where two of them mean the same.
quaternions = st.tuples(*[st.floats(-1.7, 1.7)] * 3).map(lambda v: quaternion_exp(np.array(v)))
poses = st.builds(lambda p, q: Pose(np.array(p), q), positions, quaternions)


def phone_frame(
    sequence: int = 1,
    *,
    epoch: int = 7,
    sent_us: int | None = None,
    position: tuple[float, float, float] = (0.0, 0.0, 0.0),
    quaternion_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0),
    gripper: float = 0.0,
    clutch: bool = False,
    tracking: bool = True,
    more: Flag = NONE,
) -> PhoneFrame:
    """A good frame; one every 16.7 ms of the sender's clock unless told."""
    flags = more | (Flag.CLUTCH if clutch else NONE) | (Flag.TRACKING if tracking else NONE)
    sent_us = sequence * 16_667 if sent_us is None else sent_us
    return PhoneFrame(epoch, sequence, 0, sent_us, position, quaternion_wxyz, gripper, flags)


def hand(pose_phone_in_session: Pose, *, clutch: bool, gripper: float = 0.0, more: Flag = NONE) -> HandSample:
    """An admitted frame."""
    x, y, z = pose_phone_in_session.position.tolist()
    qw, qx, qy, qz = pose_phone_in_session.quaternion_wxyz.tolist()
    frame = phone_frame(
        position=(x, y, z), quaternion_wxyz=(qw, qx, qy, qz), gripper=gripper, clutch=clutch, more=more
    )
    return HandSample(frame, pose_phone_in_session, clutch)
