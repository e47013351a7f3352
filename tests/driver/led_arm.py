"""A six-joint arm, its follower and simulated hardware, with the time in the test's hands."""

from __future__ import annotations

import mujoco
import numpy as np

from mart.driver import Measured
from mart.driver.follow import Follower, RoomTarget, ServoStep
from mart.driver.interface import Array
from mart.driver.kinematics import ArmKinematics
from mart.driver.limits import MotionLimits
from mart.driver.simulated.hardware import SERVO_HZ, ArmHardware
from mart.protocol.pose import Pose
from mart.protocol.tasks import Workspace

PERIOD_S = 1.0 / SERVO_HZ
CONTROL_HZ = 20.0
HOME_RAD = np.array([0.0, -1.2, 1.9, 0.87, 0.0, 0.0])  # elbow up, tool down
WORKSPACE = Workspace(radius_min_m=0.2, reach_m=0.75, reach_center_z_m=0.16)

_LINKS = (  # position in the parent, axis, of a UR5e-class arm
    ((0, 0, 0.163), (0, 0, 1)),
    ((0, 0.138, 0), (0, 1, 0)),
    ((0.425, -0.131, 0), (0, 1, 0)),
    ((0.392, 0, 0), (0, 1, 0)),
    ((0, 0.127, 0), (0, 0, 1)),
    ((0.0997, 0, 0), (1, 0, 0)),
)


def six_joint_model() -> mujoco.MjModel:
    """One arm of six joints that stands beside the middle of its world, with the names that rooms give."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    body = spec.worldbody.add_body(name="arm0/base", pos=(0.3, -0.1, 0.0), quat=(0.8, 0, 0, 0.6))
    for number, (position, axis) in enumerate(_LINKS, start=1):
        body = body.add_body(name=f"arm0/link{number}", pos=position)
        body.mass, body.inertia, body.explicitinertial = 1.0, (0.01, 0.01, 0.01), True
        body.add_joint(name=f"arm0/joint{number}", axis=axis, range=(-3.1, 3.1))
    body.add_site(
        name="arm0/tool", pos=(0.12, 0, 0), quat=(0.7071068, 0, -0.7071068, 0)
    )  # level while it points down
    thing = spec.worldbody.add_body(name="thing")  # the arm's joints are not the only ones
    thing.add_freejoint()
    thing.mass, thing.inertia, thing.explicitinertial = 1.0, (0.01, 0.01, 0.01), True
    return spec.compile()


class LedArm:
    """Advances follower and hardware together; the room says `target` at every tick, and hears nothing."""

    def __init__(self, limits: MotionLimits = MotionLimits(), delay_s: float = 0.02) -> None:  # noqa: B008 - frozen
        self.kinematics = ArmKinematics(six_joint_model(), "arm0")
        self.limits = limits
        self.now_s = 50.0
        self.hardware = ArmHardware(HOME_RAD.tolist(), delay_s=delay_s, jitter_s=delay_s / 4)
        self.follower = Follower(self.kinematics, WORKSPACE, limits, self.now_s)
        self.step: ServoStep | None = None
        self.tick = 0
        self.speaks = True  # whether the room is heard
        self.sent: list[Array | None] = []
        self.allowed: list[
            bool
        ] = []  # whether a clutch had been pressed that was let go of since the last stop
        self._let_go = self._pressed = False
        self._due_s = self.now_s
        self.target = self.tool
        self.engaged, self.stop, self.gripper = False, False, 0.0

    @property
    def tool(self) -> Pose:
        return self.kinematics.tool_in_base(np.array(self.hardware.joints))

    def pass_time(self, elapsed_s: float) -> None:
        for _ in range(round(elapsed_s * SERVO_HZ)):
            self.now_s += PERIOD_S
            if self.speaks and self.now_s >= self._due_s:
                self._due_s = self.now_s + 1.0 / CONTROL_HZ
                self.tick += 1
                self.follower.hear(
                    RoomTarget(self.target, self.gripper, self.engaged, self.stop, self.tick, CONTROL_HZ),
                    self.now_s,
                )
                self._let_go = not self.stop and (self._let_go or not self.engaged)
                self._pressed = not self.stop and (self._pressed or (self._let_go and self.engaged))
            self.allowed.append(self._pressed)
            self.hardware.advance(self.now_s, PERIOD_S)
            said = self.hardware.reading(self.now_s)
            measured = Measured(
                said["stamp_s"], np.array(said["joints"]), said["gripper"], fault=said["fault"]
            )
            self.step = self.follower.advance(measured, self.now_s)
            self.sent.append(self.step.joint_positions)
            if self.step.joint_positions is None:
                self.hardware.hear({"stop": True}, self.now_s)
            else:
                joints = self.step.joint_positions.tolist()
                self.hardware.hear({"servo": joints, "gripper": self.step.gripper}, self.now_s)

    def press_clutch(self) -> None:
        """Let go of the clutch, then press it."""
        self.engaged = False
        self.pass_time(0.1)
        self.engaged = True
        self.pass_time(0.1)

    def lead(self, shift_m: tuple[float, float, float]) -> None:
        """Ask for a pose so far from where the tool is."""
        self.target = Pose(self.tool.position + np.array(shift_m), self.tool.quaternion_wxyz)

    def moved_since(self, begun_s: float) -> float:
        """The largest movement of a joint after this time, radians."""
        joints = np.array([one.joints for one in self.hardware.history if one.at_s >= begun_s])
        return float(np.ptp(joints, axis=0).max())
