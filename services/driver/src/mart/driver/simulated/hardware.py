"""Simulate an arm's controller: joints that follow with a lag and a speed limit, read with noise. Pure."""

from __future__ import annotations

import math
import random
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

SERVO_HZ = 125.0
_GAIN_PER_S = 25.0  # a joint follows with a time constant of 40 ms
_SPEED_RAD_S = 2.2
_GRIPPER_PER_S = 3.0
_WATCHDOG_S = 0.2  # without a word it stands still, as controllers in their servo mode do
_NOISE_RAD = 2e-5
_KEPT_S = 120.0


class HardwareFault(StrEnum):
    """Name what can be asked to go wrong."""

    NONE = "none"
    FREEZE = "freeze"  # readings stay the same, their stamps go on
    STALE = "stale"  # the same reading again and again
    NAN = "nan"
    FAULT = "fault"  # it says so, and stands still


@dataclass(frozen=True)
class Moment:
    """Hold where the joints were, by the clock of this machine."""

    at_s: float
    joints: tuple[float, ...]


class ArmHardware:
    """Hold joints and what they were told. Commands take effect after `delay_s`, give or take `jitter_s`."""

    def __init__(
        self, joints: Sequence[float], seed: int = 0, delay_s: float = 0.020, jitter_s: float = 0.005
    ) -> None:
        self._random = random.Random(seed)
        self.joints, self._goal = list(joints), list(joints)
        self.gripper = self._gripper_goal = 0.0
        self.fault = HardwareFault.NONE
        self.history: deque[Moment] = deque(maxlen=round(_KEPT_S * SERVO_HZ))
        self._delay_s, self._jitter_s = delay_s, jitter_s
        self._waiting: deque[tuple[float, dict[str, Any]]] = deque()
        self._heard_s: float | None = None
        self._offset_s = self._random.uniform(1e3, 1e5)  # its clock is another, and runs 0.1 % fast
        self._reading: dict[str, Any] = {}

    def hear(self, message: dict[str, Any], now_s: float) -> None:
        """Take a command; in order, as a connection delivers them."""
        due_s = now_s + self._delay_s + self._random.uniform(-self._jitter_s, self._jitter_s)
        self._waiting.append((max(due_s, self._waiting[-1][0] if self._waiting else due_s), message))

    def advance(self, now_s: float, elapsed_s: float) -> None:
        """Move on to `now_s`."""
        while self._waiting and self._waiting[0][0] <= now_s:
            self._obey(self._waiting.popleft()[1])
            self._heard_s = now_s
        silent = self._heard_s is None or now_s - self._heard_s > _WATCHDOG_S
        if silent or self.fault is HardwareFault.FAULT:
            self._goal = list(self.joints)
        for index, goal in enumerate(self._goal):
            speed = min(max((goal - self.joints[index]) * _GAIN_PER_S, -_SPEED_RAD_S), _SPEED_RAD_S)
            self.joints[index] += speed * elapsed_s
        most = _GRIPPER_PER_S * elapsed_s
        self.gripper += min(max(self._gripper_goal - self.gripper, -most), most)
        self.history.append(Moment(now_s, tuple(self.joints)))

    def reading(self, now_s: float) -> dict[str, Any]:
        """Return what it says of itself, as it goes over the connection."""
        if self.fault is HardwareFault.STALE and self._reading:
            return self._reading
        joints = [joint + self._random.gauss(0.0, _NOISE_RAD) for joint in self.joints]
        if self.fault is HardwareFault.FREEZE and self._reading:
            joints = self._reading["joints"]
        if self.fault is HardwareFault.NAN:
            joints = [math.nan] * len(joints)
        self._reading = {
            "stamp_s": self._offset_s + 1.001 * now_s,
            "joints": joints,
            "gripper": self.gripper,
            "fault": "Joint 3 is too hot." if self.fault is HardwareFault.FAULT else "",
        }
        return self._reading

    def _obey(self, message: dict[str, Any]) -> None:
        if message.get("stop"):
            self._goal = list(self.joints)
        elif len(goal := message.get("servo", ())) == len(self.joints):
            self._goal = [float(value) for value in goal]
            self._gripper_goal = min(max(float(message.get("gripper", 0.0)), 0.0), 1.0)
