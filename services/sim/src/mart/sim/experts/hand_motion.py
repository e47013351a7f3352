"""Move a reference towards a goal as a human hand does: with limited speed, misses and a tremor.

A movement has a first part that ends beside its goal, by an error in proportion to its speed, and corrections that
follow when the error has been seen: the optimized initial impulse model (Meyer, Abrams, Kornblum, Wright, Smith 1988).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import (
    Pose,
    quaternion_conjugate,
    quaternion_exp,
    quaternion_log,
    quaternion_multiply,
)
from mart.sim.experts.human_error import HumanErrorModel

_TREMOR_TIME_S = 0.4  # how long the tremor takes to wander off
_SLOWING_PER_S = 6.0  # near its goal a hand slows down in proportion to what is left
# The reference waits for a tool that lags further than this: seen 4 ticks late at 0.3 m/s it is 6 cm behind anyway.
_LEASH_M = 0.15
_LEASH_RAD = 0.9
_ARRIVED_M, _ARRIVED_RAD = 0.004, 0.03  # of the reference
_FOLLOWED_M, _FOLLOWED_RAD = 0.015, 0.12  # of the measured tool, tremor included
_NEW_GOAL_M, _NEW_GOAL_RAD = (
    0.02,
    0.2,
)  # a goal that jumps further begins a movement; one that drifts is followed

Vector = NDArray[np.float64]


class HandMotion:
    """Follow goals with the pose where the person wants the tool: the reference, kept without its tremor."""

    def __init__(self, human: HumanErrorModel) -> None:
        self._human = human
        self._speed_factor = human.random.uniform(0.85, 1.15)  # people differ
        self._tremor = np.zeros(6)
        self._miss = np.zeros(6)  # of the movement under way: translation, rotation vector
        self._correct_in_s = 0.0
        self._goal: Pose | None = None
        self._reference: Pose | None = None
        self._resting: Pose | None = None

    def move(self, goal: Pose, measured: Pose, pace: float, elapsed_s: float) -> Pose:
        """Go on towards `goal` for `elapsed_s` at `pace` times the usual speed; return the pose to command."""
        start, self._resting = self._reference or measured, None
        if self._goal is None or not _near(goal, self._goal, _NEW_GOAL_M, _NEW_GOAL_RAD):
            self._begin(difference(goal, start), pace)
        self._goal = goal
        shift, turn = difference(moved(goal, self._miss[:3], self._miss[3:]), start)
        skill, factor = self._human.skill, pace * self._speed_factor
        step = _shortened(shift, _stride(shift, skill.speed_m_per_s * factor, elapsed_s))
        turn_step = _shortened(turn, _stride(turn, skill.turn_rad_per_s * factor, elapsed_s))
        self._reference = _leashed(moved(start, step, turn_step), measured)
        if _small(shift, turn):
            self._correct(pace, elapsed_s)
        self._shake(elapsed_s)
        return moved(self._reference, self._tremor[:3], self._tremor[3:])

    def has_reached(self, goal: Pose, measured: Pose) -> bool:
        """Whether both the reference and the tool are at the goal."""
        if self._reference is None:
            return False
        return _near(goal, self._reference, _ARRIVED_M, _ARRIVED_RAD) and _near(
            goal, measured, _FOLLOWED_M, _FOLLOWED_RAD
        )

    def rest(self, measured: Pose) -> Pose:
        """Return the pose to command while the clutch is let go: always the same. The next move starts at the tool."""
        if self._resting is None:
            self._resting = self._reference or measured
        self._reference = self._goal = None
        return self._resting

    def _begin(self, way: tuple[Vector, Vector], pace: float) -> None:
        """Begin a movement: its first part will end beside the goal, more often too far than too short."""
        random, share = self._human.random, self._human.skill.overshoot * pace
        shift, turn = way
        along = share * random.normal(0.5, 1.0, 2)
        across = share * 0.3 * float(np.linalg.norm(shift)) * random.standard_normal(3)
        self._miss = np.concatenate([along[0] * shift + across, along[1] * turn])
        self._correct_in_s = self._human.notices_s()

    def _correct(self, pace: float, elapsed_s: float) -> None:
        """Count down until the miss of the first part is noticed; what is left of it is a movement like any other."""
        self._correct_in_s -= elapsed_s
        if self._correct_in_s > 0.0:
            return
        miss, self._miss = self._miss, np.zeros(6)
        if not _small(miss[:3], miss[3:]):
            self._begin((-miss[:3], -miss[3:]), pace)

    def _shake(self, elapsed_s: float) -> None:
        """Advance the tremor by an Ornstein-Uhlenbeck step, exact for any time."""
        skill = self._human.skill
        spread = np.repeat([skill.tremor_m, skill.tremor_rad], 3)
        keep = np.exp(-elapsed_s / _TREMOR_TIME_S)
        drive = self._human.random.standard_normal(6)
        self._tremor = keep * self._tremor + spread * np.sqrt(1 - keep**2) * drive


def difference(goal: Pose, start: Pose) -> tuple[Vector, Vector]:
    """Return translation (metres) and rotation vector (radians), along the parent's axes, from `start` to `goal`."""
    turn = quaternion_multiply(goal.quaternion_wxyz, quaternion_conjugate(start.quaternion_wxyz))
    return goal.position - start.position, quaternion_log(turn)


def moved(start: Pose, shift: Vector, turn: Vector) -> Pose:
    """Return the pose that `difference` leads to from `start`."""
    return Pose(start.position + shift, quaternion_multiply(quaternion_exp(turn), start.quaternion_wxyz))


def _leashed(reference: Pose, measured: Pose) -> Pose:
    shift, turn = difference(reference, measured)
    return moved(measured, _shortened(shift, _LEASH_M), _shortened(turn, _LEASH_RAD))


def _near(goal: Pose, pose: Pose, metres: float, radians: float) -> bool:
    distance_m, angle_rad = goal.distance_to(pose)
    return distance_m < metres and angle_rad < radians


def _small(shift: Vector, turn: Vector) -> bool:
    return float(np.linalg.norm(shift)) < _ARRIVED_M and float(np.linalg.norm(turn)) < _ARRIVED_RAD


def _stride(way: Vector, speed: float, elapsed_s: float) -> float:
    left = float(np.linalg.norm(way))
    return min(speed * elapsed_s, left * min(1.0, _SLOWING_PER_S * elapsed_s) + 0.005 * elapsed_s)


def _shortened(vector: Vector, length: float) -> Vector:
    size = float(np.linalg.norm(vector))
    return vector if size <= length else vector * (length / size)
