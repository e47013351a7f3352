"""Watch an arm's readings: faults, numbers that cannot be, readings that stand still or are too old. Pure."""

from __future__ import annotations

import numpy as np

from mart.driver.interface import Array, Measured
from mart.driver.limits import BEYOND_RANGE_RAD, FOLLOWS_WITHIN_RAD, FROZEN_AFTER_S, MotionLimits


class ReadingWatch:
    """Say what is wrong with the readings of one connection, each looked at as it comes."""

    def __init__(self, lowest: Array, highest: Array, limits: MotionLimits) -> None:
        """Watch an arm whose joints are between `lowest` and `highest`, radians, shape (joint_count,)."""
        self._lowest, self._highest, self._limits = lowest, highest, limits
        self._stamp_s: float | None = None
        self._stamped_s = 0.0  # by our clock, when the newest stamp came
        self._joints: Array | None = None
        self._moved_s = 0.0  # by our clock, when joint positions last changed or need not change

    def age_s(self, now_s: float) -> float:
        """Return for how long the newest stamp has been known, by our own clock."""
        return max(0.0, now_s - self._stamped_s) if self._stamp_s is not None else 0.0

    def objection(self, measured: Measured, sent: Array | None, now_s: float) -> str:
        """Return what is wrong, a sentence; empty where nothing is. sent: joint positions sent last, None: none."""
        return (
            self._not_a_reading(measured)
            or (f"The arm reports: {measured.fault}" if measured.fault else "")
            or self._clock(measured, now_s)
            or self._frozen(measured.joint_positions, sent, now_s)
            or self._beyond_limits(measured, sent)
        )

    def _not_a_reading(self, measured: Measured) -> str:
        joints = np.asarray(measured.joint_positions, dtype=np.float64)
        if joints.shape != self._lowest.shape:
            return f"A reading of {joints.size} joints came; the arm has {self._lowest.size}."
        if not np.isfinite([measured.stamp_s, measured.gripper, *joints]).all():
            return "A reading with NaN or infinity came."
        if not -0.5 <= measured.gripper <= 1.5:
            return f"A gripper of {measured.gripper:g} was read; 0 is open and 1 closed."
        return self._out_of_range(joints)

    def _out_of_range(self, joints: Array) -> str:
        beyond = np.maximum(self._lowest - joints, joints - self._highest)
        joint = int(beyond.argmax())
        if beyond[joint] <= BEYOND_RANGE_RAD:
            return ""
        return (
            f"Joint {joint + 1} was read at {joints[joint]:.2f} rad; the model has it between "
            f"{self._lowest[joint]:.2f} and {self._highest[joint]:.2f}. Is it in degrees, or of other zeros?"
        )

    def _clock(self, measured: Measured, now_s: float) -> str:
        if self._stamp_s is None or measured.stamp_s > self._stamp_s:
            self._stamp_s, self._stamped_s = measured.stamp_s, now_s
        elif measured.stamp_s < self._stamp_s:
            back_s, self._stamp_s, self._stamped_s = self._stamp_s - measured.stamp_s, measured.stamp_s, now_s
            return f"The stamps of readings went back by {back_s:.3g} s: the clock they are of was set."
        if self.age_s(now_s) >= FROZEN_AFTER_S:
            return f"No new reading came for {FROZEN_AFTER_S:g} s."
        return ""

    def _frozen(self, joints: Array, sent: Array | None, now_s: float) -> str:
        same = self._joints is not None and np.array_equal(joints, self._joints)
        there = sent is None or float(np.abs(sent - joints).max()) <= FOLLOWS_WITHIN_RAD
        self._joints = np.array(joints)
        if not same or there:
            self._moved_s = now_s
        if now_s - self._moved_s >= FROZEN_AFTER_S:
            return f"Readings stood still for {FROZEN_AFTER_S:g} s while the arm was to move."
        return ""

    def _beyond_limits(self, measured: Measured, sent: Array | None) -> str:
        if measured.load is not None and not measured.load < self._limits.load:
            return f"The load is {measured.load:.2f} of what is allowed; {self._limits.load:g} is the limit."
        if sent is None:
            return ""
        behind = np.abs(sent - measured.joint_positions)
        if float(behind.max()) > self._limits.lag_rad:
            joint = int(behind.argmax()) + 1
            return (
                f"The arm does not follow: joint {joint} is {behind.max():.2f} rad behind; "
                f"{self._limits.lag_rad:g} is the limit."
            )
        return ""
