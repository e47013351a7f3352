"""Tell how a tool moves from state to state, and where it comes to rest once nobody leads it. Pure."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_exp, quaternion_log, quaternion_multiply

Array = NDArray[np.float64]

# How much further an arm goes when it is let go, as seconds at its present velocity. Measured in the simulated world
# at 0.27 m/s, 20 to 100 ticks a second, commands 0 to 2 ticks late: with 0.05 s it comes to rest within 17 to 34 mm
# and 0.25 s and never goes back; with nothing it goes 5 mm too far and returns, with 0.1 s it goes on for 45 mm.
STOPPING_S = 0.05
_RESTING_M_PER_S = 0.01
_RESTING_RAD_PER_S = 0.1
_LONGEST_STEP_S = 0.5  # between states that are further apart nothing is known of the motion


def _still() -> Array:
    return np.zeros(3)


@dataclass(frozen=True)
class ToolMotion:
    """Hold where a tool is in its arm's base frame, and how it moves: m/s and rad/s of the simulated time."""

    pose_tool_in_base: Pose
    sim_time_s: float = 0.0
    velocity_m_per_s: Array = field(default_factory=_still)
    turning_rad_per_s: Array = field(default_factory=_still)

    def after(self, pose_tool_in_base: Pose, sim_time_s: float) -> ToolMotion:
        """Return the motion once the tool was seen there; at rest where too much or no time has passed."""
        elapsed_s = sim_time_s - self.sim_time_s
        if elapsed_s == 0.0:
            return self  # a state that was repeated
        if not 0.0 < elapsed_s <= _LONGEST_STEP_S:
            return ToolMotion(pose_tool_in_base, sim_time_s)
        before = self.pose_tool_in_base
        turn = quaternion_multiply(
            pose_tool_in_base.quaternion_wxyz, quaternion_conjugate(before.quaternion_wxyz)
        )
        return ToolMotion(
            pose_tool_in_base,
            sim_time_s,
            (pose_tool_in_base.position - before.position) / elapsed_s,
            quaternion_log(turn) / elapsed_s,
        )

    @property
    def rests(self) -> bool:
        """Whether the tool stands still."""
        return (
            float(np.linalg.norm(self.velocity_m_per_s)) < _RESTING_M_PER_S
            and float(np.linalg.norm(self.turning_rad_per_s)) < _RESTING_RAD_PER_S
        )

    def stopping_pose(self) -> Pose:
        """Return where the tool is, plus its stopping distance: a target there stops it without a way back."""
        here = self.pose_tool_in_base
        turn = quaternion_exp(STOPPING_S * self.turning_rad_per_s)
        return Pose(
            here.position + STOPPING_S * self.velocity_m_per_s,
            quaternion_multiply(turn, here.quaternion_wxyz),
        )


class Stopping:
    """Find the target that stops a tool: led by each new state until it rests, and fixed from then on.

    A target that went on following the measured pose would let a loaded arm sink. At least LEAST_S are followed,
    because a command that led on may still be on its way when the clutch opens.
    """

    LEAST_S = 0.15
    LONGEST_S = 0.5

    def __init__(self, motion: ToolMotion) -> None:
        self.target_tool_in_base = motion.stopping_pose()
        self._since_s = motion.sim_time_s
        self._settled = False

    def see(self, motion: ToolMotion) -> Pose:
        """Take the newest motion and return the target."""
        if not self._settled:
            self.target_tool_in_base = motion.stopping_pose()
            elapsed_s = motion.sim_time_s - self._since_s
            self._settled = elapsed_s >= self.LONGEST_S or (elapsed_s >= self.LEAST_S and motion.rests)
        return self.target_tool_in_base
