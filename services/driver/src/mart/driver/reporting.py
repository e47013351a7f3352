"""Say on the bus how an arm stands."""

from __future__ import annotations

import numpy as np

from mart.driver.follow import ServoStep
from mart.driver.interface import Measured
from mart.protocol import codec, keys
from mart.protocol.messages import DRIVER_PHASE_STOPPED, ArmMeasured, pose_message
from mart.runtime.bus import Bus

_MOST_HZ = 125.0
_MAX_FAULT_CHARACTERS = 500


class Reporter:
    """Publish the readings of one arm, at most 125 times a second; used by one thread."""

    def __init__(self, bus: Bus, room: str, arm: str) -> None:
        self._room, self._arm = room, arm
        self._publisher = bus.publisher(keys.arm_measured(room, arm))
        self._sequence = 0
        self._due_s = 0.0

    def report(self, session: int, measured: Measured, step: ServoStep, age_s: float, now_s: float) -> None:
        """Publish a reading and what was made of it, where one is due."""
        if now_s < self._due_s:
            return
        self._due_s = now_s + 0.9 / _MOST_HZ  # as often as the servo turns, at its pace
        joints = np.asarray(measured.joint_positions, dtype=np.float64)
        usable = bool(np.isfinite(joints).all()) and np.isfinite(measured.gripper)
        self._put(
            ArmMeasured(
                session=session,
                joint_positions=joints.tolist() if usable else [],
                tool_in_base=pose_message(step.tool_in_base),
                gripper=min(max(measured.gripper, 0.0), 1.0) if usable else 0.0,
                phase=step.phase,
                fault=step.fault[:_MAX_FAULT_CHARACTERS],
                reason=step.reason,
                age_s=age_s,
                follows_tick=step.follows_tick,
            )
        )

    def fault(self, session: int, fault: str) -> None:
        """Publish that there is no reading, and why."""
        self._put(
            ArmMeasured(session=session, phase=DRIVER_PHASE_STOPPED, fault=fault[:_MAX_FAULT_CHARACTERS])
        )

    def close(self) -> None:
        """Close the publisher."""
        self._publisher.close()

    def _put(self, message: ArmMeasured) -> None:
        self._sequence += 1
        message.room, message.arm, message.sequence = self._room, self._arm, self._sequence
        self._publisher.put(codec.encode(message))
