"""Make any of LeRobot's robots a driver."""

from __future__ import annotations

from mart.driver.interface import Array, Driver, DriverFault, Measured
from mart.driver.lerobot_arm.options import arm_options
from mart.driver.lerobot_arm.robot_thread import LeRobotRobot, RobotThread
from mart.driver.lerobot_arm.robots import counts_in_degrees, float_features, make_robot
from mart.protocol import clock

_CONNECT_TIMEOUT_S = 30.0  # some wait for their cameras' first pictures


class LeRobotArm(Driver):
    """Drive the robot `type` of LeRobot's, or of a plugin for it; `docs/how-to-use-lerobot-robots.md` has the options.

    It is never calibrated here and never asks a person; where the robot lets us say so, torque stays on at the end.
    """

    def __init__(self, **given: str) -> None:
        """Raise InvalidInput or NotFound, with what is allowed, for options that cannot be."""
        options = arm_options(given)
        self.kind, self.rate_hz = options.kind, options.rate_hz
        self.joint_count = len(options.mapping.joint)
        self._options, self._mapping = options, options.mapping
        self._robot: LeRobotRobot | None = self._make()
        self._thread: RobotThread | None = None
        self._gripper: float | None = None  # as it was last told
        self._held: dict[str, float] | None = None  # while it is to stand

    def connect(self) -> None:
        """Connect, without calibrating, and wait for a first reading."""
        if self._thread is not None and not self._thread.close():
            raise DriverFault(
                f"{self._options.type} still hangs: switch it off and on, and start the driver anew."
            )
        robot, self._robot = self._robot or self._make(), None
        self._gripper = self._held = None
        self._thread = RobotThread(robot, self._options.type, self.rate_hz)
        self._thread.connect(_CONNECT_TIMEOUT_S)

    def read(self) -> Measured:
        """Return the newest reading; of a robot that blocks, with a fault that says where."""
        thread = self._connected()
        reading = thread.reading()
        joints, gripper = self._mapping.read(reading.observation)
        return Measured(reading.asked_s, joints, gripper, fault=thread.slowness(clock.monotonic_s()))

    def servo(self, joint_positions: Array, gripper: float) -> None:
        """Send where the joints are to be next, in the robot's own units."""
        self._held, self._gripper = None, gripper
        self._connected().send(self._mapping.action(joint_positions, gripper))

    def stop(self) -> None:
        """Hold the arm where it was measured when it was first told to stop; what the gripper holds, it keeps."""
        thread = self._connected()
        if self._held is None:
            if thread.slowness(clock.monotonic_s()):
                thread.send(None)  # where it is now will be known when it answers
                return
            joints, gripper = self._mapping.read(thread.reading().observation)
            self._held = self._mapping.action(joints, gripper if self._gripper is None else self._gripper)
        thread.send(self._held)

    def close(self) -> None:
        """Disconnect, once the last word has been sent."""
        if self._thread is not None and self._thread.close():
            self._thread = None

    def _make(self) -> LeRobotRobot:
        robot = make_robot(self._options.type, self._options.fields)
        observed, taken = float_features(robot.observation_features), float_features(robot.action_features)
        self._mapping.require_features(self._options.type, observed, taken)
        in_degrees = counts_in_degrees(robot)
        if in_degrees is not None:
            self._mapping.require_unit(self._options.type, in_degrees=in_degrees)
        return robot

    def _connected(self) -> RobotThread:
        if self._thread is None:
            raise DriverFault(f"{self._options.type} is not connected.")
        return self._thread
