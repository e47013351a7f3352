"""A room with two real arms, their drivers, simulated hardware and two people, all in the test's own time.

Networks take 5 ms, hardware 20 ms give or take 5 with a clock of its own, servos turn 125 times a second.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable
from functools import partial

import numpy as np

from mart.driver import Measured
from mart.driver.follow import Follower, RoomTarget
from mart.driver.kinematics import ArmKinematics
from mart.driver.limits import MotionLimits
from mart.driver.simulated.hardware import SERVO_HZ, ArmHardware
from mart.protocol import codec
from mart.protocol.messages import (
    DRIVER_PHASE_STOPPED,
    OPERATOR_HUMAN,
    ArmMeasured,
    ArmTarget,
    Command,
    DriverHello,
    pose_from_message,
    pose_message,
)
from mart.protocol.pose import Pose
from mart.protocol.wire_version import DRIVER_WIRE_VERSION
from mart.sim.room.driven_arms import ArmFacts, DrivenArms
from mart.sim.world import World
from mart.sim.world.driven_world import DrivenWorld
from tests.sim.room.room_harness import ARMS, RoomHarness
from tests.sim.world.simulated_drivers import HOME_RAD

_STEP_S = 0.002
_NETWORK_S = 0.005
_COMMANDS_S = 0.02
_REPORTS_S = 0.05  # of a driver without hardware
_MOVES_RAD = 0.002
LIMITS = MotionLimits(tool_speed_m_s=0.5, joint_speed_rad_s=2.0)


class RehearsedDriver:
    """One driver's process. killed: it is no more. unplugged: its hardware is not connected. cut: its network."""

    def __init__(self, world: World, arm: str, session: int, hardware: ArmHardware, now_s: float) -> None:
        self.arm, self.hardware, self.session = arm, hardware, session
        self.killed = self.unplugged = self.cut = False
        self._follower = Follower(
            ArmKinematics(world.model, arm), world.task.arm(arm).kind.workspace, LIMITS, now_s
        )
        self._sequence, self._report_due_s = 0, now_s

    def hear(self, target: ArmTarget, now_s: float) -> None:
        if not (self.killed or self.cut) and target.session == self.session:
            pose = pose_from_message(target.target_tool_in_base)
            self._follower.hear(
                RoomTarget(pose, target.gripper, target.engaged, target.stop, target.tick, target.control_hz),
                now_s,
            )

    def turn(self, now_s: float) -> ArmMeasured | None:
        """One turn of the servo; what it says to the room, where that gets through."""
        if self.killed:
            return None
        said = ArmMeasured(arm=self.arm, session=self.session)
        if self.unplugged:
            if now_s < self._report_due_s:
                return None
            self._report_due_s = now_s + _REPORTS_S
            said.phase, said.fault = DRIVER_PHASE_STOPPED, "The connection to the hardware was lost."
        else:
            self._servo(said, now_s)
        self._sequence += 1
        said.sequence = self._sequence
        return None if self.cut else said

    def _servo(self, said: ArmMeasured, now_s: float) -> None:
        read = self.hardware.reading(now_s)
        measured = Measured(read["stamp_s"], np.array(read["joints"]), read["gripper"], fault=read["fault"])
        step = self._follower.advance(measured, now_s)
        if step.joint_positions is None:
            self.hardware.hear({"stop": True}, now_s)
        else:
            self.hardware.hear({"servo": step.joint_positions.tolist(), "gripper": step.gripper}, now_s)
        usable = np.isfinite(measured.joint_positions).all()
        said.joint_positions.extend(measured.joint_positions.tolist() if usable else [])
        said.gripper, said.phase, said.fault = min(max(measured.gripper, 0.0), 1.0), step.phase, step.fault
        said.age_s = self._follower.age_s(now_s)


class Rehearsal(RoomHarness):
    """Everything together; both people swing their tools sideways while they press their clutches."""

    def __init__(self, world: World) -> None:
        self._flying: list[tuple[float, int, Callable[[float], None]]] = []
        self._order = itertools.count()
        self._compiled = world
        facts = {arm: ArmFacts("panda", 7, "m") for arm in ARMS}
        self.link = DrivenArms("room-1", facts, 20.0, self._send)
        self.drivers: dict[str, RehearsedDriver] = {}
        self.engaged = False
        self._held: dict[str, Pose] = {}
        self._servo_due_s = self._command_due_s = 0.0
        super().__init__(DrivenWorld(world, self.link), drivers=self.link)
        self.hardware = {arm: ArmHardware(HOME_RAD, seed) for seed, arm in enumerate(ARMS)}
        for arm in ARMS:
            self.start_driver(arm)
        self.pass_time(0.2)

    def start_driver(self, arm: str) -> None:
        hello = DriverHello(
            arm=arm,
            driver="SimulatedArm",
            instance=f"{arm} {next(self._order)}",
            kind="panda",
            joints=7,
            model_sha256="m",
            wire_version=DRIVER_WIRE_VERSION,
        )
        session = self.link.hello(hello, self.now_s).session
        self.drivers[arm] = RehearsedDriver(self._compiled, arm, session, self.hardware[arm], self.now_s)

    def pass_time(self, elapsed_s: float) -> None:
        end_s = self.now_s + elapsed_s
        while self.now_s < end_s:
            self.now_s += _STEP_S
            while self._flying and self._flying[0][0] <= self.now_s:
                heapq.heappop(self._flying)[2](self.now_s)
            for hardware in self.hardware.values():
                hardware.advance(self.now_s, _STEP_S)
            if self.now_s >= self._servo_due_s:
                self._servo_due_s = self.now_s + 1.0 / SERVO_HZ
                self._turn_servos()
            if self.now_s >= self._command_due_s:
                self._command_due_s = self.now_s + _COMMANDS_S
                self._speak()
            self.room.advance(self.now_s)

    def press(self) -> None:
        """Both people let go of their clutches and press them."""
        self.engaged = False
        self.pass_time(0.2)
        self.engaged = True

    def stood_after_s(self, begun_s: float) -> float:
        """For how long any arm still moved after this time, at its hardware."""
        last_s = begun_s
        for hardware in self.hardware.values():
            rows = np.array([(one.at_s, *one.joints) for one in hardware.history if one.at_s >= begun_s])
            moving = np.abs(rows[:, 1:] - rows[-1, 1:]).max(axis=1) > _MOVES_RAD
            last_s = max(last_s, float(rows[moving, 0].max()) if moving.any() else begun_s)
        return last_s - begun_s

    def least_moved_rad(self, begun_s: float) -> float:
        return min(self._moved(begun_s))

    def most_moved_rad(self, begun_s: float) -> float:
        return max(self._moved(begun_s))

    def _moved(self, begun_s: float) -> list[float]:
        paths = [[m.joints for m in one.history if m.at_s >= begun_s] for one in self.hardware.values()]
        return [float(np.ptp(np.array(path), axis=0).max()) for path in paths]

    def _send(self, target: ArmTarget) -> None:
        kept = ArmTarget()
        kept.CopyFrom(target)
        self._later(
            lambda now_s: self.drivers[kept.arm].hear(kept, now_s) if kept.arm in self.drivers else None
        )

    def _turn_servos(self) -> None:
        for driver in self.drivers.values():
            said = driver.turn(self.now_s)
            if said is not None:
                self._later(partial(self.link.hear, said))

    def _later(self, arrives: Callable[[float], None]) -> None:
        heapq.heappush(self._flying, (self.now_s + _NETWORK_S, next(self._order), arrives))

    def _speak(self) -> None:
        for seat in self.status().seats:
            if seat.operator != OPERATOR_HUMAN:
                continue
            tool = self.world.tool_pose_in_base(seat.arm)
            middle = self._held.setdefault(seat.arm, tool)
            away_m = 0.10 * np.sin(2.5 * self.now_s)
            swung = Pose(middle.position + np.array([0.0, away_m, 0.0]), middle.quaternion_wxyz)
            self._sequence += 1
            command = Command(
                arm=seat.arm,
                seat_epoch=seat.epoch,
                sequence=self._sequence,
                target_tool_in_base=pose_message(swung if self.engaged else tool),
                engaged=self.engaged,
            )
            self.room.hear(codec.encode(command), seat.arm, self.now_s, round(self.now_s * 1e9))
