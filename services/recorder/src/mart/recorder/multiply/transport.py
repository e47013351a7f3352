"""Carry poses from one place to another, and lead one way over into another. Pure.

A thing is carried upright: what counts of its turn is that about the vertical axis. So a way that grips from above
stays one, wherever the thing lies. Positions are in metres, in the world; quaternions are wxyz.
"""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import (
    Array,
    quaternion_conjugate,
    quaternion_exp,
    quaternion_log,
    quaternion_multiply,
    rotate,
)

_UPRIGHT = 0.5  # an axis whose share in the level plane is smaller points up or down


def yaw_of(quaternion_wxyz: Array) -> float:
    """Return how far a frame is turned about the vertical axis, radians: by its x axis, or y where x stands upright."""
    x, y, _ = rotate(quaternion_wxyz, np.array([1.0, 0.0, 0.0])).tolist()
    if math.hypot(x, y) >= _UPRIGHT:
        return math.atan2(y, x)
    x, y, _ = rotate(quaternion_wxyz, np.array([0.0, 1.0, 0.0])).tolist()
    return math.atan2(-x, y)


def turned(vector: Array, yaw_rad: float) -> Array:
    """Return a vector, shape (3,), turned about the vertical axis."""
    x, y, z = vector.tolist()
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array([c * x - s * y, s * x + c * y, z])


def yaw_quaternion(yaw_rad: float) -> Array:
    """Return the quaternion of a turn about the vertical axis."""
    return np.array([math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2)])


def folded(yaw_rad: float, order: int) -> float:
    """Return the smallest turn that looks the same for a thing that looks the same `order` times a round."""
    return math.remainder(yaw_rad, math.tau / order)


def carried(position: Array, origin: Array, new_origin: Array, yaw_rad: float) -> Array:
    """Return a position that lies to `new_origin` as it lay to `origin`, turned by `yaw_rad` about the vertical."""
    return new_origin + turned(position - origin, yaw_rad)


def min_jerk(share: float) -> float:
    """Return how far a motion of least jerk is after this share of it; both from 0 to 1."""
    s = min(max(share, 0.0), 1.0)
    return s * s * s * (10.0 + s * (-15.0 + 6.0 * s))


def between(a: Array, b: Array, share: float) -> Array:
    """Return the quaternion at this share of the shorter turn from `a` to `b`."""
    if share <= 0.0:
        return a
    turn = quaternion_log(quaternion_multiply(b, quaternion_conjugate(a)))
    return quaternion_multiply(quaternion_exp(share * turn), a)


def angle_between(a: Array, b: Array) -> float:
    """Return the angle of the turn from `a` to `b`, radians."""
    return float(np.linalg.norm(quaternion_log(quaternion_multiply(b, quaternion_conjugate(a)))))
