"""Rehearse without hardware: a robot and a teleoperator of LeRobot's kind, found as anybody's plugin is.

LeRobot ships no mock: its `mock_robot` lies in the tests of its repository alone.
"""

from __future__ import annotations

import json
import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lerobot.robots import Robot, RobotConfig
from lerobot.teleoperators import Teleoperator, TeleoperatorConfig

_HOME_DEG = (0.0, math.degrees(0.2), 0.0, math.degrees(-2.1), 0.0, math.degrees(2.3), math.degrees(0.785))
_SPEED_DEG_S = 120.0


@RobotConfig.register_subclass("rehearsal_arm")
@dataclass(kw_only=True)
class RehearsalArmConfig(RobotConfig):  # type: ignore[misc]  # LeRobot says no types
    """Configure it.

    joints: how many. hang_file: while there is such a file, reading hangs. asks: for a person's Enter. report: a file
    into which it writes where it is at the end.
    """

    joints: int = 7
    hang_file: str = ""
    asks: bool = False
    calibrated: bool = True
    report: str = ""


class RehearsalArm(Robot):  # type: ignore[misc]  # LeRobot says no types
    """Move joints towards what was sent, at a limited speed; degrees, gripper 0 closed … 100 open."""

    config_class = RehearsalArmConfig
    name = "rehearsal_arm"

    def __init__(self, config: RehearsalArmConfig) -> None:
        super().__init__(config)
        self.config = config
        self.cameras: dict[str, Any] = {}
        self._connected = False
        self._at = {f"joint{i + 1}.pos": _HOME_DEG[i % 7] for i in range(config.joints)} | {
            "gripper.pos": 100.0
        }
        self._goal = dict(self._at)
        self._moved_s = time.monotonic()

    @property
    def observation_features(self) -> dict[str, type]:
        return dict.fromkeys(self._at, float)

    @property
    def action_features(self) -> dict[str, type]:
        return dict.fromkeys(self._at, float)

    @property
    def is_connected(self) -> bool:
        return self._connected

    @property
    def is_calibrated(self) -> bool:
        return self.config.calibrated

    def connect(self, calibrate: bool = True) -> None:
        if self.config.asks or (calibrate and not self.is_calibrated):
            input("Press Enter when the arm is in its middle: ")
        self._connected = True

    def calibrate(self) -> None:
        """Nothing to calibrate."""

    def configure(self) -> None:
        """Nothing to configure."""

    def get_observation(self) -> dict[str, float]:
        if self.config.hang_file:
            while Path(self.config.hang_file).exists():
                time.sleep(0.01)
        now_s = time.monotonic()
        most = _SPEED_DEG_S * (now_s - self._moved_s)
        self._moved_s = now_s
        for key, goal in self._goal.items():
            self._at[key] += min(max(goal - self._at[key], -most), most)
        return dict(self._at)

    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        self._goal.update(action)
        return action

    def disconnect(self) -> None:
        if self._connected and self.config.report:
            Path(self.config.report).write_text(json.dumps(self._at))
        self._connected = False


@TeleoperatorConfig.register_subclass("rehearsal_hand")
@dataclass(kw_only=True)
class RehearsalHandConfig(TeleoperatorConfig):  # type: ignore[misc]  # LeRobot says no types
    """Configure it. z: what it says of the tool's way up, -1 … 1."""

    z: float = 0.5


class RehearsalHand(Teleoperator):  # type: ignore[misc]  # LeRobot says no types
    """Say one action again and again: the tool's way up."""

    config_class = RehearsalHandConfig
    name = "rehearsal_hand"

    def __init__(self, config: RehearsalHandConfig) -> None:
        super().__init__(config)
        self.config = config
        self._connected = False

    @property
    def action_features(self) -> dict[str, type]:
        return dict.fromkeys(self.get_action(), float)

    @property
    def feedback_features(self) -> dict[str, type]:
        return {}

    @property
    def is_connected(self) -> bool:
        return self._connected

    @property
    def is_calibrated(self) -> bool:
        return True

    def connect(self, calibrate: bool = True) -> None:
        self._connected = True

    def calibrate(self) -> None:
        """Nothing to calibrate."""

    def configure(self) -> None:
        """Nothing to configure."""

    def get_action(self) -> dict[str, float]:
        names = ("x", "y", "z", "turn_x", "turn_y", "turn_z", "gripper")
        return dict.fromkeys(names, 0.0) | {"z": self.config.z, "gripper": -1.0}

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Feel nothing."""

    def disconnect(self) -> None:
        self._connected = False
