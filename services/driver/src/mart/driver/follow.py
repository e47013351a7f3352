"""Follow a room's targets with one arm, or hold, or stop: a pure state machine. Readings, targets and `now` go in.

Between two ticks' targets it leads the tool on a straight line, at most as fast as the limits allow. Whatever stops
the arm is latched: afterwards nothing moves until a clutch is pressed that had been let go of since.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mart.driver.interface import Array, Measured
from mart.driver.kinematics import ArmKinematics
from mart.driver.limits import HOLD_AFTER_S, LOST_AFTER_S, SAME_TOOL_M, MotionLimits
from mart.driver.readings import ReadingWatch
from mart.protocol.messages import (
    DRIVER_PHASE_FOLLOWING,
    DRIVER_PHASE_HOLDING,
    DRIVER_PHASE_STOPPED,
    DriverPhase,
)
from mart.protocol.pose import (
    Pose,
    quaternion_conjugate,
    quaternion_exp,
    quaternion_log,
    quaternion_multiply,
)
from mart.protocol.tasks import Workspace


@dataclass(frozen=True)
class RoomTarget:
    """Hold what a room asked for; see the message ArmTarget."""

    tool_in_base: Pose
    gripper: float
    engaged: bool
    stop: bool
    tick: int
    control_hz: float


@dataclass(frozen=True)
class ServoStep:
    """Tell what to do now. joint_positions: None, stand still; fault: why the driver stopped; reason: why it holds."""

    phase: DriverPhase
    joint_positions: Array | None
    gripper: float
    tool_in_base: Pose
    fault: str = ""
    reason: str = ""
    follows_tick: int = 0


class Follower:
    """Lead one arm for one session with a room. Times are seconds on one monotonic clock of this process."""

    def __init__(
        self,
        kinematics: ArmKinematics,
        workspace: Workspace,
        limits: MotionLimits,
        now_s: float,
    ) -> None:
        self._kinematics, self._workspace, self._limits = kinematics, workspace, limits
        self._watch = ReadingWatch(kinematics.lowest, kinematics.highest, limits)
        self._target: RoomTarget | None = None
        self._heard_s = self._advanced_s = now_s
        self._let_go = self._armed = False  # of the clutch, since the last stop; and pressed after that
        self._fault, self._fault_known = "", True  # what stopped the arm; whether the room has stopped for it
        self._sent: Array | None = None  # joint positions, while it follows
        self._setpoint = self._line_from = self._line_to = Pose.identity()
        self._posture = np.zeros(kinematics.joint_count)
        self._posture_azimuth_rad = 0.0
        self._gripper: float | None = None
        self._tool = Pose.identity()

    def age_s(self, now_s: float) -> float:
        """Return the age of the newest reading."""
        return self._watch.age_s(now_s)

    def hear(self, target: RoomTarget, now_s: float) -> None:
        """Take a target of the room."""
        self._heard_s = now_s
        if target.stop:
            self._disarm()
            self._fault_known = True
        elif not target.engaged and not self._armed:
            self._let_go = True
        elif target.engaged and self._let_go:
            self._armed = True
        self._line_from = self._setpoint
        self._line_to = self._workspace.clamp(target.tool_in_base)
        self._target = target

    def advance(self, measured: Measured, now_s: float) -> ServoStep:
        """Return what to do at this reading."""
        elapsed_s = min(max(now_s - self._advanced_s, 0.0), 0.05)
        self._advanced_s = now_s
        objection = self._watch.objection(measured, self._sent, now_s) or self._silence(now_s)
        if not objection:
            self._tool = self._kinematics.tool_in_base(measured.joint_positions)
            self._gripper = measured.gripper if self._gripper is None else self._gripper
            objection = self._other_tool(measured)
        if objection:
            self.stop(objection)
        elif self._fault_known:
            self._fault = ""
        if self._fault:
            return self._still(DRIVER_PHASE_STOPPED, "", self._fault)
        why = self._why_it_holds(now_s)
        if why or self._target is None:
            return self._still(DRIVER_PHASE_HOLDING, why)
        return self._follow(self._target, measured, now_s, elapsed_s)

    def stop(self, fault: str) -> None:
        """Stop the arm for a fault, which is latched until the room has stopped for it and it is gone."""
        if not self._fault:
            self._fault = fault
            self._fault_known = False
        self._disarm()

    def _disarm(self) -> None:
        self._armed = self._let_go = False
        self._sent = None

    def _silence(self, now_s: float) -> str:
        if self._target is not None and now_s - self._heard_s >= LOST_AFTER_S:
            return f"The room was not heard for {LOST_AFTER_S:g} s."
        return ""

    def _other_tool(self, measured: Measured) -> str:
        if measured.pose_tool_in_base is None:
            return ""
        away_m = float(np.linalg.norm(measured.pose_tool_in_base.position - self._tool.position))
        if away_m <= SAME_TOOL_M:
            return ""
        return (
            f"The arm says that its tool is {away_m:.2f} m from where the room's model has it: "
            "another arm, another tool or another base."
        )

    def _why_it_holds(self, now_s: float) -> str:
        target = self._target
        if target is None:
            return "No target has come yet."
        if target.stop:
            return "The room is stopped."
        if not self._armed:
            return "The clutch has not been pressed since it stopped."
        if now_s - self._heard_s >= HOLD_AFTER_S:
            return f"No target came for {HOLD_AFTER_S:g} s."
        return ""

    def _still(self, phase: DriverPhase, reason: str, fault: str = "") -> ServoStep:
        self._sent = None
        return ServoStep(phase, None, self._gripper or 0.0, self._tool, fault, reason)

    def _follow(self, target: RoomTarget, measured: Measured, now_s: float, elapsed_s: float) -> ServoStep:
        if self._sent is None:
            self._begin(measured)
            sent = np.array(measured.joint_positions, dtype=np.float64)
        else:
            sent = self._sent
        waited_s = max(now_s - self._heard_s, 0.0)  # what came while the arm was read is of this turn
        share = min(1.0, waited_s * target.control_hz) if target.control_hz > 0.0 else 1.0
        wanted = _between(self._line_from, self._line_to, share)
        self._setpoint = _within_speed(self._setpoint, wanted, self._limits, elapsed_s)
        joints = self._kinematics.towards(sent, self._setpoint, self._preferred())
        largest = self._limits.joint_speed_rad_s * elapsed_s
        step = joints - sent
        fastest = float(np.abs(step).max())
        if fastest > largest:
            joints = sent + step * (largest / fastest)
            self._setpoint = self._kinematics.tool_in_base(joints)  # the tool waits for its joints
        self._sent = joints
        self._gripper = min(max(target.gripper, 0.0), 1.0)
        return ServoStep(DRIVER_PHASE_FOLLOWING, joints, self._gripper, self._tool, follows_tick=target.tick)

    def _begin(self, measured: Measured) -> None:
        """Start from where the arm is: what stood in between is no way to lead it."""
        self._setpoint = self._line_from = self._tool
        self._posture = np.array(measured.joint_positions, dtype=np.float64)
        self._posture_azimuth_rad = _azimuth(self._tool)

    def _preferred(self) -> Array:
        """Return the posture of the beginning, turned with the tool about the base's axis: the elbow stays over it."""
        posture = self._posture.copy()
        posture[0] += (
            np.remainder(_azimuth(self._setpoint) - self._posture_azimuth_rad + np.pi, 2 * np.pi) - np.pi
        )
        return posture


def _azimuth(pose: Pose) -> float:
    return float(np.arctan2(pose.position[1], pose.position[0]))


def _between(begin: Pose, end: Pose, share: float) -> Pose:
    """Return the pose on the straight way from `begin` to `end`, which turns about one axis meanwhile."""
    turn = quaternion_log(
        quaternion_multiply(end.quaternion_wxyz, quaternion_conjugate(begin.quaternion_wxyz))
    )
    return Pose(
        begin.position + share * (end.position - begin.position),
        quaternion_multiply(quaternion_exp(share * turn), begin.quaternion_wxyz),
    )


def _within_speed(begin: Pose, end: Pose, limits: MotionLimits, elapsed_s: float) -> Pose:
    away_m, away_rad = begin.distance_to(end)
    share = min(
        1.0,
        limits.tool_speed_m_s * elapsed_s / max(away_m, 1e-12),
        limits.tool_speed_rad_s * elapsed_s / max(away_rad, 1e-12),
    )
    return end if share >= 1.0 else _between(begin, end, share)
