"""Tell plans where things are in the own arm's base frame, and how a tool would grip them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from mart.protocol.pose import Pose, quaternion_exp, quaternion_multiply
from mart.protocol.tasks import Arm
from mart.sim.experts.plan import OperatorObservation

ObservedPose = Callable[[OperatorObservation], Pose]

_UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])


def seen(arm: Arm, thing: str) -> ObservedPose:
    """Return a function that finds a thing in this arm's base frame; unturned where only its position is seen."""
    return _seen(arm, f"{thing}/position_in_world", f"{thing}/quaternion_in_world")


def seen_tool(arm: Arm, partner: str) -> ObservedPose:
    """Return a function that finds the partner's tool in this arm's base frame: its position alone."""
    return _seen(arm, f"{partner}/tool_position_in_world", "")


def _seen(arm: Arm, position: str, quaternion: str) -> ObservedPose:
    base_from_world = arm.pose_base_in_world.inverse()
    return lambda now: (
        base_from_world @ Pose(now.observations[position], now.observations.get(quaternion, _UNTURNED))
    )


def at(x: float, y: float, z: float) -> Pose:
    """Return a place in a frame (metres), unturned."""
    return Pose(np.array([x, y, z]), _UNTURNED)


def upright(position: ArrayLike, yaw_rad: float) -> Pose:
    """Return the pose of a thing that stands, or of a tool that points straight down, turned by `yaw_rad`."""
    half = yaw_rad / 2
    return Pose(np.asarray(position), np.array([math.cos(half), 0.0, 0.0, math.sin(half)]))


def standing(place: Pose, like: Pose, symmetry_rad: float) -> Pose:
    """Return a pose standing at a place, square to it, turned from `like` as little as the symmetry allows."""
    return upright(place.position, _yaw(place, _yaw(like), symmetry_rad))


def level(place: Pose, like: Pose) -> Pose:
    """Return a pose at a place, x axis along the place's (either way), on that of its four sides `like` is near."""
    along, x = place.rotation_matrix()[:, 0], like.rotation_matrix()[:, 0]
    along = along if along @ x > 0.0 else -along
    axis = np.cross(x, along)
    sine = max(float(np.linalg.norm(axis)), 1e-9)
    turn = quaternion_exp(axis / sine * math.asin(min(sine, 1.0)))
    rolled = Pose(place.position, quaternion_multiply(turn, like.quaternion_wxyz))
    _, up_of_y, up_of_z = rolled.rotation_matrix()[2]
    roll = math.remainder(math.atan2(up_of_y, up_of_z), math.pi / 2)
    return Pose(place.position, quaternion_multiply(quaternion_exp(-roll * along), rolled.quaternion_wxyz))


def across(thing: Pose, symmetry_rad: float = math.pi) -> Pose:
    """Return the tool that grips a thing from above, with the fingers on either side of its x axis."""
    return upright(thing.position, _yaw(thing, symmetry_rad=symmetry_rad))


def apart_m(one: Pose, other: Pose) -> float:
    """Return the distance of two poses' positions in metres."""
    return one.distance_to(other)[0]


def uprightness(pose: Pose) -> float:
    """Return the cosine of a pose's tilt: 1 where it stands."""
    return float(pose.rotation_matrix()[2, 2])


def _yaw(pose: Pose, nearest_to_rad: float = 0.0, symmetry_rad: float = math.tau) -> float:
    x, y, _ = pose.rotation_matrix()[:, 0]
    return nearest_to_rad + math.remainder(math.atan2(y, x) - nearest_to_rad, symmetry_rad)


class StillnessDetector:
    """Tell whether what is seen stayed within `within_m` of one place for `for_s`; ask at every observation."""

    def __init__(self, see: ObservedPose, within_m: float, for_s: float) -> None:
        self._see, self._within_m, self._for_s = see, within_m, for_s
        self._place: Pose | None = None
        self._since_s = 0.0

    def __call__(self, now: OperatorObservation) -> bool:
        here = self._see(now)
        if self._place is None or apart_m(here, self._place) > self._within_m:
            self._place, self._since_s = here, now.sim_time_s
        return now.sim_time_s - self._since_s >= self._for_s
