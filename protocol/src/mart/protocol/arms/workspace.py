"""Bound what an arm's tool may be told: how far ahead at a time, and where."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict

from mart.protocol.pose import Pose


@dataclass(frozen=True)
class Limits:
    """How far ahead of its measured pose a tool may be told to go, at every tick and every tick rate.

    The servo follows at a speed in proportion to what is ahead, so this limits speed: 5 cm is 0.27 m/s at 20 Hz and
    0.29 m/s at 60 Hz. A limit that shrank with the tick would make arms three times slower at 60 Hz (0.10 m/s).
    """

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid")

    step_m: float = 0.05
    step_rad: float = 0.5


@dataclass(frozen=True)
class Workspace:
    """Bound where a tool may be sent, in the arm's base frame: part of a shell around the base axis, over the table.

    Measured with the hand pointing down: nearer to the axis than `radius_min_m` a joint meets its limit; further than
    `reach_m` from the point at `reach_center_z_m` on the axis the arm is stretched; beside and behind its base it ties
    itself up. The limits of tilt (from straight down) and yaw (from the direction of reach) keep the wrist off its own.
    The defaults are the Panda's, whose hand is mounted at 45 degrees, so that its yaw has more room on one side.
    """

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid")

    radius_min_m: float = 0.28
    reach_m: float = 0.78
    reach_center_z_m: float = 0.12
    azimuth_max_rad: float = 1.2
    z_min_m: float = 0.0
    z_max_m: float = 0.65
    tilt_max_rad: float = 0.85
    yaw_min_rad: float = -1.9
    yaw_max_rad: float = 2.7

    def reach_at_m(self, z_m: float) -> float:
        """How far from the base's axis a tool may go at this height; 0 where it may not be that high or low."""
        return math.sqrt(max(0.0, self.reach_m**2 - (z_m - self.reach_center_z_m) ** 2))

    def clamp(self, pose_tool_in_base: Pose) -> Pose:
        """An allowed pose close to the given one; an allowed one is returned as it is, but for rounding."""
        x, y, z = self._position(*pose_tool_in_base.position.tolist())
        turn = self._turn(math.atan2(y, x), *pose_tool_in_base.quaternion_wxyz.tolist())
        return Pose(np.array([x, y, z]), turn)

    def _position(self, x: float, y: float, z: float) -> tuple[float, float, float]:
        z = _clip(z, self.z_min_m, self.z_max_m)
        farthest_m = math.sqrt(self.reach_m**2 - (z - self.reach_center_z_m) ** 2)
        radius = _clip(math.hypot(x, y), self.radius_min_m, farthest_m)
        azimuth = _clip(math.atan2(y, x), -self.azimuth_max_rad, self.azimuth_max_rad)
        return radius * math.cos(azimuth), radius * math.sin(azimuth), z

    def _turn(self, azimuth: float, w: float, x: float, y: float, z: float) -> NDArray[np.float64]:
        """Every rotation is a turn about the vertical axis and then a tilt about a level one: limits each by itself."""
        yaw, tilt = 2 * math.atan2(z, w), 2 * math.atan2(math.hypot(x, y), math.hypot(w, z))
        tilt_direction = math.atan2(y, x) + yaw / 2
        middle = azimuth + (self.yaw_min_rad + self.yaw_max_rad) / 2
        largest = (self.yaw_max_rad - self.yaw_min_rad) / 2
        yaw = middle + _clip(math.remainder(yaw - middle, math.tau), -largest, largest)
        tilt = min(tilt, self.tilt_max_rad)
        level, lean = math.cos(tilt / 2), math.sin(tilt / 2)
        return np.array(
            [
                level * math.cos(yaw / 2),
                lean * math.cos(tilt_direction - yaw / 2),
                lean * math.sin(tilt_direction - yaw / 2),
                level * math.sin(yaw / 2),
            ]
        )


def _clip(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
