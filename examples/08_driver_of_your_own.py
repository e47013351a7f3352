"""Connect an arm of your own: what a driver must do, with a toy in the place of the hardware.

Start the platform with a real arm in its room, and this as that arm, in a second terminal:

    mart run --driver arm0
    mart driver --arm arm0 --driver examples/08_driver_of_your_own.py:ToyArm

The room stands until the driver is there and somebody lets the stop go; the arm moves once a clutch is pressed.
"""

from __future__ import annotations

import time

import numpy as np

from mart.driver import Driver, DriverFault, Measured


class ToyArm(Driver):
    """A Panda that is exactly where it was told to be, and never in a hurry."""

    kind, joint_count, rate_hz = "panda", 7, 100.0

    def __init__(self, slow: str = "no") -> None:
        self.gain = 0.1 if slow == "yes" else 0.4

    def connect(self) -> None:
        self.joints = np.array([0.0, 0.2, 0.0, -2.1, 0.0, 2.3, 0.785])  # read them from the arm
        self.gripper = 0.0

    def read(self) -> Measured:
        if not np.isfinite(self.joints).all():
            raise DriverFault("The toy is broken.")
        return Measured(time.monotonic(), self.joints.copy(), self.gripper)

    def servo(self, joint_positions: np.ndarray, gripper: float) -> None:
        self.joints += self.gain * (joint_positions - self.joints)
        self.gripper = gripper

    def stop(self) -> None:
        pass  # it stands where it is, unless it is told to move

    def close(self) -> None:
        pass


if __name__ == "__main__":
    arm = ToyArm()
    arm.connect()
    for _ in range(20):
        arm.servo(arm.joints + 0.01, gripper=1.0)
    print("The toy moved to", arm.read().joint_positions.round(2))
