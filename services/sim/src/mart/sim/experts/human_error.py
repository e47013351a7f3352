"""Draw the errors and delays of one person of a skill, attempt by attempt."""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.sim.experts.skill import Skill

_PRACTICE = 0.7  # how much of an error is left at the next attempt
_HASTE_M = (0.015, 0.05)  # before the place, when the gripper is closed too early
CLOSING_S = 0.45  # fingers take six ticks to grip a thing


class HumanErrorModel:
    """Draw from `random` alone, so a seed decides what a person does; a plan's own choices may use it as well."""

    def __init__(self, skill: Skill, random: np.random.Generator) -> None:
        self.skill = skill
        self.random = random
        self._attempts = 0

    def varied(self, mean: float) -> float:
        """Draw a time or a size like `mean`: within 30 % of it."""
        return mean * self.random.uniform(0.7, 1.3)

    def reacts_s(self) -> float:
        """Draw the seconds before the first movement."""
        return self.varied(self.skill.reaction_s)

    def settles_s(self) -> float:
        """Draw the seconds for which this person looks at a place before going on."""
        return self.varied(self.skill.settle_s)

    def notices_s(self) -> float:
        """Draw the seconds until this person acts on what is to be seen."""
        return self.varied(self.skill.notice_s)

    def aims(self) -> Pose:
        """Draw where the next attempt grips, in the frame of the tool that would grip well.

        Less wide of it every time, because people learn from a miss.
        """
        left = _PRACTICE**self._attempts
        self._attempts += 1
        shift = self.random.normal(0.0, self.skill.aim_m * left, 3) * (1.0, 1.0, 0.5)
        yaw = self.random.normal(0.0, self.skill.aim_rad * left)
        return Pose(shift, np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]))

    def closes_before_m(self) -> float:
        """Draw how far before the place (metres) the gripper is closed: 0 unless in haste."""
        return self.random.uniform(*_HASTE_M) if self._hastes() else 0.0

    def grips_s(self) -> float:
        """Draw the seconds for which this person waits for the fingers: enough unless in haste."""
        return self.random.uniform(0.1, 0.3) if self._hastes() else CLOSING_S + self.settles_s()

    def lets_slip(self, elapsed_s: float) -> bool:
        """Draw whether what is held slips from this hand within `elapsed_s`."""
        return bool(self.random.random() < -math.expm1(-self.skill.slip_per_s * elapsed_s))

    def pauses_s(self) -> float:
        """Draw the seconds for which the clutch is let go before the next movement; mostly 0."""
        return self.varied(self.skill.pause_s) if self.random.random() < self.skill.pause_probability else 0.0

    def _hastes(self) -> bool:
        return bool(self.random.random() < self.skill.haste)
