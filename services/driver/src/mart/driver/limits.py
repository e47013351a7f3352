"""Define the limits that a driver enforces, whatever the room says."""

from __future__ import annotations

from dataclasses import dataclass

HOLD_AFTER_S = 0.25  # without a target
LOST_AFTER_S = 1.0  # a room repeats its targets 20 times a second, also while it stands still
FROZEN_AFTER_S = 0.1
FOLLOWS_WITHIN_RAD = 0.02  # of what was sent, a reading may stay the same: coarse sensors at slow motion
BEYOND_RANGE_RAD = 0.2  # of a joint, that a reading may be: zeros are never quite the model's
SAME_TOOL_M = 0.05  # where the arm and the room's model may disagree about the tool


@dataclass(frozen=True)
class MotionLimits:
    """Bound how an arm is led. The defaults are for a first day.

    tool_speed_m_s: the reduced speed of ISO 10218-1. tool_speed_rad_s, joint_speed_rad_s: of turning. lag_rad: by how
    much a joint may be behind what was sent, before the arm counts as blocked. load: share of the hardware's largest
    force or current, where the driver tells it.
    """

    tool_speed_m_s: float = 0.25
    tool_speed_rad_s: float = 1.5
    joint_speed_rad_s: float = 1.0
    lag_rad: float = 0.2
    load: float = 1.0
