"""Rigid transforms, SE(3), as position and unit quaternion.

Conventions, stated once: positions in metres; quaternions `wxyz`, unit norm, canonical with w >= 0; `a @ b` applies
`b` first. `pose_tool_in_base` is the tool's frame seen from the base frame, so
`pose_base_in_world @ pose_tool_in_base == pose_tool_in_world`. A twist is (v, ω): metres, then radians.
Exp and log: Solà et al., "A micro Lie theory for state estimation in robotics" (2018), equations 172–179.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mart.protocol.errors import InvalidInput

Array = NDArray[np.float64]

_SMALL_ANGLE_RAD = 1e-8
QUATERNION_NORM_TOLERANCE = 1e-2  # a quaternion off by more than this was never meant to be one


@dataclass(frozen=True, eq=False)
class Pose:
    """A pose; both arrays are read-only copies.

    position: shape (3,), metres. quaternion_wxyz: shape (4,), normalised here; raises InvalidInput where the
    numbers are not finite or the norm is more than 1 % from 1.
    """

    position: Array
    quaternion_wxyz: Array

    def __post_init__(self) -> None:
        position = _vector("position", self.position, 3)
        quaternion = _vector("quaternion_wxyz", self.quaternion_wxyz, 4)
        norm = math.sqrt(quaternion @ quaternion)
        if abs(norm - 1.0) > QUATERNION_NORM_TOLERANCE:
            raise InvalidInput(f"A quaternion of norm {norm:.4f} was given; it must be within 1 % of 1.")
        quaternion /= norm
        if quaternion[0] < 0:
            quaternion = -quaternion
        for name, value in (("position", position), ("quaternion_wxyz", quaternion)):
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    @classmethod
    def identity(cls) -> Pose:
        return cls(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))

    @classmethod
    def from_matrix(cls, rotation: ArrayLike, position: ArrayLike) -> Pose:
        """Make a pose of a rotation matrix, shape (3, 3), orthonormal, and a position, shape (3,), metres."""
        return cls(
            np.asarray(position, dtype=np.float64), quaternion_from_matrix(np.asarray(rotation, np.float64))
        )

    @classmethod
    def exp(cls, twist: ArrayLike) -> Pose:
        """The pose reached by following `twist`, shape (6,), for one unit of time."""
        v, omega = np.split(_vector("twist", twist, 6), 2)
        return cls(_left_jacobian(omega) @ v, quaternion_exp(omega))

    def log(self) -> Array:
        """The twist, shape (6,), with `Pose.exp(twist) == self` and rotation angle at most π."""
        omega = quaternion_log(self.quaternion_wxyz)
        return np.concatenate([np.linalg.solve(_left_jacobian(omega), self.position), omega])

    def __matmul__(self, other: Pose) -> Pose:
        return Pose(
            self.position + rotate(self.quaternion_wxyz, other.position),
            quaternion_multiply(self.quaternion_wxyz, other.quaternion_wxyz),
        )

    def inverse(self) -> Pose:
        conjugate = quaternion_conjugate(self.quaternion_wxyz)
        return Pose(-rotate(conjugate, self.position), conjugate)

    def rotation_matrix(self) -> Array:
        """Shape (3, 3); its columns are this frame's axes seen from the parent."""
        return np.column_stack([rotate(self.quaternion_wxyz, axis) for axis in np.eye(3)])

    def transform_points(self, points: ArrayLike) -> Array:
        """Return points, shape (..., 3), given in this frame, in the parent frame."""
        return np.asarray(points, dtype=np.float64) @ self.rotation_matrix().T + self.position

    def distance_to(self, other: Pose) -> tuple[float, float]:
        """How far apart: (metres, radians)."""
        turn = quaternion_multiply(quaternion_conjugate(self.quaternion_wxyz), other.quaternion_wxyz)
        metres = float(np.linalg.norm(other.position - self.position))
        return metres, float(np.linalg.norm(quaternion_log(turn)))


def quaternion_multiply(a: Array, b: Array) -> Array:
    """Hamilton product of two wxyz quaternions, shape (4,)."""
    aw, ax, ay, az = a.tolist()  # Python's floats: arithmetic on numpy's scalars is several times slower
    bw, bx, by, bz = b.tolist()
    return np.array(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ]
    )


def quaternion_conjugate(quaternion_wxyz: Array) -> Array:
    return quaternion_wxyz * np.array([1.0, -1.0, -1.0, -1.0])


def quaternion_exp(rotation_vector: Array) -> Array:
    """Return the unit quaternion of a rotation vector: axis times angle, shape (3,), radians."""
    angle = float(np.linalg.norm(rotation_vector))
    half = 0.5 * angle
    scale = 0.5 if angle < _SMALL_ANGLE_RAD else np.sin(half) / angle
    return np.concatenate([[np.cos(half)], scale * rotation_vector])


def quaternion_log(quaternion_wxyz: Array) -> Array:
    """Axis times angle, shape (3,), radians, angle in [0, π]."""
    q = -quaternion_wxyz if quaternion_wxyz[0] < 0 else quaternion_wxyz
    sine = float(np.linalg.norm(q[1:]))
    scale = 2.0 if sine < _SMALL_ANGLE_RAD else 2.0 * np.arctan2(sine, q[0]) / sine
    return scale * q[1:]


def rotate(quaternion_wxyz: Array, vector: Array) -> Array:
    """Turns a vector, shape (3,), by a unit quaternion."""
    w, u = quaternion_wxyz[0], quaternion_wxyz[1:]
    t = 2.0 * _cross(u, vector)
    return vector + w * t + _cross(u, t)


def quaternion_from_matrix(rotation: Array) -> Array:
    """Return the quaternion of a rotation matrix, shape (3, 3). Shepperd's method: divides by the largest component."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    squares = (xx + yy + zz, xx - yy - zz, yy - xx - zz, zz - xx - yy)
    largest = squares.index(max(squares))
    s = 2.0 * math.sqrt(1.0 + squares[largest])
    candidates = (
        (s / 4, (zy - yz) / s, (xz - zx) / s, (yx - xy) / s),
        ((zy - yz) / s, s / 4, (xy + yx) / s, (xz + zx) / s),
        ((xz - zx) / s, (xy + yx) / s, s / 4, (yz + zy) / s),
        ((yx - xy) / s, (xz + zx) / s, (yz + zy) / s, s / 4),
    )
    return np.array(candidates[largest])


def _cross(a: Array, b: Array) -> Array:
    # np.cross costs 20 us a call on three numbers; this is on every tick's path.
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _left_jacobian(omega: Array) -> Array:
    """Solà et al. equation 174; shape (3, 3)."""
    angle = float(np.linalg.norm(omega))
    x, y, z = omega
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-5:  # series: the closed form loses digits here
        return np.eye(3) + 0.5 * skew + skew @ skew / 6.0
    sine_term = (1.0 - np.cos(angle)) / angle**2
    return np.eye(3) + sine_term * skew + (angle - np.sin(angle)) / angle**3 * skew @ skew


def _vector(name: str, value: ArrayLike, size: int) -> Array:
    array = np.array(value, dtype=np.float64)
    if array.shape != (size,):
        raise InvalidInput(f"{name} of shape {array.shape} was given; it must have shape ({size},).")
    if not all(map(math.isfinite, array.tolist())):
        raise InvalidInput(f"{name} {array.tolist()} was given; every number must be finite.")
    return array
