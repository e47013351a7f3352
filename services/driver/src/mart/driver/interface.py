"""Define what a driver of an arm has to do. Everything else is done around it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Unavailable
from mart.protocol.pose import Pose

Array = NDArray[np.float64]


class DriverFault(Unavailable):
    """Tell, in a sentence, that the hardware cannot be used any more; raise it from any method of a `Driver`."""


@dataclass(frozen=True)
class Measured:
    """Hold one reading of an arm.

    stamp_s: when it was measured, seconds on any clock that never goes back, the hardware's own where it has one.
    joint_positions: radians, in the order of the model's joints. gripper: 0 open … 1 closed.
    pose_tool_in_base: where the arm itself says its tool is; None where it does not. fault: what is wrong with it, a
    sentence; empty while all is well. load: the largest force or current as a share of what is allowed; None where
    the hardware does not tell.
    """

    stamp_s: float
    joint_positions: Array
    gripper: float = 0.0
    pose_tool_in_base: Pose | None = None
    fault: str = ""
    load: float | None = field(default=None)


class Driver(ABC):
    """Connect one arm. Methods are called from one thread, `read` and `servo` in turn `rate_hz` times a second.

    None may block for more than a few control periods: what is late counts as silence, and stops the room. An
    exception stops the arm and is told to everybody; then `connect` is called anew after a while.

    kind: of arm, as the room names it. joint_count: of its joints without the gripper. rate_hz: of its servo.
    Options of the command line are given to the constructor, as strings.
    """

    kind: str
    joint_count: int
    rate_hz: float

    @abstractmethod
    def connect(self) -> None:
        """Open the connection. The arm must not move. Raises DriverFault where that fails."""

    @abstractmethod
    def read(self) -> Measured:
        """Return the newest reading, without waiting for a new one for longer than a control period."""

    @abstractmethod
    def servo(self, joint_positions: Array, gripper: float) -> None:
        """Send where the joints are to be next, shape (joint_count,), radians, and the gripper, 0 open … 1 closed.

        What is sent is within the limits already, and near to what was sent before.
        """

    @abstractmethod
    def stop(self) -> None:
        """Bring the arm to a stand at once and hold it; called again and again while it is to stand."""

    @abstractmethod
    def close(self) -> None:
        """Close the connection; called once after `connect`, whether it failed or not. The arm must hold still."""
