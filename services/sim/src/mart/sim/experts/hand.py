"""The human part of a scripted operator: moves a reference towards a waypoint, with limited speed and a tremor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.experts.skill import Skill

_TREMOR_TIME_S = 0.4  # how long the tremor takes to wander off
_SLOWING_PER_S = 6.0  # near its goal a hand slows down in proportion to what is left
# The reference waits for a tool that lags further than this: seen 4 ticks late at 0.3 m/s it is 6 cm behind anyway.
_LEASH_M = 0.15
_LEASH_RAD = 0.9
_ARRIVED_M, _ARRIVED_RAD = 0.004, 0.03  # of the reference
_FOLLOWED_M, _FOLLOWED_RAD = 0.015, 0.12  # of the measured tool, tremor included


class Hand:
    """Holds where the person wants the tool to be, as the reference without tremor."""

    def __init__(self, skill: Skill, random: np.random.Generator) -> None:
        self._skill = skill
        self._random = random
        self._speed_factor = random.uniform(0.85, 1.15)  # people differ
        self._tremor = np.zeros(6)
        self._reference: Pose | None = None

    def move(self, goal: Pose, measured: Pose, pace: float, elapsed_s: float) -> Pose:
        """One moment of moving towards `goal` at `pace` times the usual speed; the pose to command."""
        start = self._reference or measured
        factor = pace * self._speed_factor
        shift, turn = difference(goal, start)
        shift = _shortened(shift, _stride(shift, self._skill.speed_m_per_s * factor, elapsed_s))
        turn = _shortened(turn, _stride(turn, self._skill.turn_rad_per_s * factor, elapsed_s))
        self._reference = _leashed(moved(start, shift, turn), measured)
        self._shake(elapsed_s)
        return moved(self._reference, self._tremor[:3], self._tremor[3:])

    def has_reached(self, goal: Pose, measured: Pose) -> bool:
        """Both the wish and the tool are at the goal."""
        if self._reference is None:
            return False
        return _near(goal, self._reference, _ARRIVED_M, _ARRIVED_RAD) and _near(
            goal, measured, _FOLLOWED_M, _FOLLOWED_RAD
        )

    def rest(self, measured: Pose) -> Pose:
        """The pose to command while the clutch is let go; moving on starts from the measured one."""
        last = self._reference or measured
        self._reference = None
        return last

    def _shake(self, elapsed_s: float) -> None:
        """An Ornstein-Uhlenbeck step, exact for any time."""
        spread = np.repeat([self._skill.tremor_m, self._skill.tremor_rad], 3)
        keep = np.exp(-elapsed_s / _TREMOR_TIME_S)
        self._tremor = keep * self._tremor + spread * np.sqrt(1 - keep**2) * self._random.standard_normal(6)


def difference(goal: Pose, start: Pose) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Translation (metres) and rotation vector (radians), both along the parent's axes, from `start` to `goal`."""
    turn = Pose(np.zeros(3), goal.quaternion_wxyz) @ Pose(np.zeros(3), start.quaternion_wxyz).inverse()
    return goal.position - start.position, turn.log()[3:]


def moved(start: Pose, shift: NDArray[np.float64], turn: NDArray[np.float64]) -> Pose:
    """The inverse of `difference`."""
    turned = Pose.exp(np.concatenate([np.zeros(3), turn])) @ Pose(np.zeros(3), start.quaternion_wxyz)
    return Pose(start.position + shift, turned.quaternion_wxyz)


def _leashed(reference: Pose, measured: Pose) -> Pose:
    shift, turn = difference(reference, measured)
    return moved(measured, _shortened(shift, _LEASH_M), _shortened(turn, _LEASH_RAD))


def _near(goal: Pose, pose: Pose, metres: float, radians: float) -> bool:
    distance_m, angle_rad = goal.distance_to(pose)
    return distance_m < metres and angle_rad < radians


def _stride(way: NDArray[np.float64], speed: float, elapsed_s: float) -> float:
    left = float(np.linalg.norm(way))
    return min(speed * elapsed_s, left * min(1.0, _SLOWING_PER_S * elapsed_s) + 0.005 * elapsed_s)


def _shortened(vector: NDArray[np.float64], length: float) -> NDArray[np.float64]:
    size = float(np.linalg.norm(vector))
    return vector if size <= length else vector * (length / size)
