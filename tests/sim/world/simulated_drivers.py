"""Drivers with simulated hardware, in the world's own time: what would be processes beside real arms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from mart.driver import Measured
from mart.driver.follow import Follower, RoomTarget
from mart.driver.kinematics import ArmKinematics
from mart.driver.limits import MotionLimits
from mart.driver.simulated.hardware import SERVO_HZ, ArmHardware
from mart.protocol.messages import DRIVER_PHASE_STOPPED
from mart.protocol.pose import Pose
from mart.sim.world import World
from mart.sim.world.driven_world import ArmReading

HOME_RAD = (0.0, 0.2, 0.0, -2.1, 0.0, 2.3, 0.785)


class SimulatedDriver:
    """One arm's driver and hardware; its clutch is pressed as soon as it may be."""

    def __init__(self, world: World, arm: str, limits: MotionLimits, seed: int) -> None:
        self.hardware = ArmHardware(HOME_RAD, seed)
        self._follower = Follower(ArmKinematics(world.model, arm), world.task.workspace, limits, 0.0)
        self._now_s, self._ticks, self._control_hz = 0.0, 0, world.control_hz

    def follow(self, tool_in_base: Pose, gripper: float) -> None:
        """Follow a target for one control period."""
        self._ticks += 1
        target = RoomTarget(tool_in_base, gripper, self._ticks > 1, False, self._ticks, self._control_hz)
        self._follower.hear(target, self._now_s)
        end_s = self._ticks / self._control_hz
        while self._now_s < end_s - 1e-9:
            self._now_s += 1.0 / SERVO_HZ
            self.hardware.advance(self._now_s, 1.0 / SERVO_HZ)
            said = self.hardware.reading(self._now_s)
            step = self._follower.advance(
                Measured(said["stamp_s"], np.array(said["joints"]), said["gripper"]), self._now_s
            )
            assert step.phase != DRIVER_PHASE_STOPPED, step.fault
            if step.joint_positions is None:
                self.hardware.hear({"stop": True}, self._now_s)
            else:
                self.hardware.hear(
                    {"servo": step.joint_positions.tolist(), "gripper": step.gripper}, self._now_s
                )

    def reading(self) -> ArmReading:
        """What it measures now."""
        return ArmReading(np.array(self.hardware.joints), self.hardware.gripper)


class SimulatedDrivers:
    """The drivers of some arms of a world; see `DriverLink`."""

    def __init__(self, world: World, arms: Sequence[str], limits: MotionLimits) -> None:
        self.drivers: Mapping[str, SimulatedDriver] = {
            arm: SimulatedDriver(world, arm, limits, seed) for seed, arm in enumerate(arms)
        }

    @property
    def arms(self) -> Sequence[str]:
        return tuple(self.drivers)

    def reading(self, arm: str) -> ArmReading | None:
        return self.drivers[arm].reading()

    def aim(self, arm: str, tool_in_base: Pose, gripper: float) -> None:
        self.drivers[arm].follow(tool_in_base, gripper)
