"""Drive LeRobot's own SO-101 follower, its serial bus replaced by one of software; run where LeRobot is installed.

Prints, in one JSON object, what was read and what was written.
"""

from __future__ import annotations

import contextlib
import json
import time
from collections.abc import Iterator
from typing import Any
from unittest import mock

import numpy as np

from mart.driver.lerobot_arm import LeRobotArm

_JOINTS = "shoulder_pan.pos,-shoulder_lift.pos,elbow_flex.pos,wrist_flex.pos,wrist_roll.pos"


class SoftwareBus:
    """Has what SO101Follower asks of its FeetechMotorsBus."""

    def __init__(self, port: str, motors: dict[str, Any], calibration: object = None) -> None:
        self.port, self.motors = port, motors
        self.is_connected = False
        self.is_calibrated = True
        self.torque: bool | None = None
        self.at = dict.fromkeys(motors, 10.0)
        self.written: list[dict[str, float]] = []
        BUSES.append(self)

    def connect(self) -> None:
        self.is_connected = True

    def disconnect(self, disable_torque: bool = True) -> None:
        self.is_connected, self.torque = False, not disable_torque

    @contextlib.contextmanager
    def torque_disabled(self) -> Iterator[None]:
        yield

    def configure_motors(self) -> None:
        """Nothing to configure."""

    def write(self, _name: str, _motor: str, _value: float) -> None:
        """Nothing to set up."""

    def sync_read(self, _name: str) -> dict[str, float]:
        return dict(self.at)

    def sync_write(self, _name: str, values: dict[str, float]) -> None:
        self.written.append(values)
        self.at.update(values)


BUSES: list[SoftwareBus] = []


def main() -> None:
    """Connect, read, write, stop, disconnect."""
    with mock.patch("lerobot.robots.so_follower.so_follower.FeetechMotorsBus", SoftwareBus):
        arm = LeRobotArm(
            type="so101_follower", port="/dev/null", id="toy", joints=_JOINTS, gripper="gripper.pos"
        )
        arm.connect()
        read = arm.read()
        arm.servo(np.array([0.1, 0.2, 0.3, 0.4, 0.5]), 1.0)
        until_s = time.monotonic() + 10.0
        while not BUSES[0].written and time.monotonic() < until_s:
            time.sleep(0.01)
        arm.stop()
        arm.close()
    print(
        json.dumps(
            {
                "joints_rad": read.joint_positions.tolist(),
                "gripper": read.gripper,
                "written": BUSES[0].written,
                "torque": BUSES[0].torque,
            }
        )
    )


if __name__ == "__main__":
    main()
