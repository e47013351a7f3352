"""Keep the drivers of a room's real arms: who they are, what they measured, what they are told. Pure, but for `send`.

A driver says hello and gets a session; readings of other sessions count for nothing. Whatever is wrong with one arm is
a trouble of the whole room, in words.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.messages import (
    DRIVER_PHASE_STOPPED,
    ArmMeasured,
    ArmTarget,
    DrivenArm,
    DriverHello,
    DriverReply,
    State,
    pose_message,
)
from mart.protocol.pose import Pose
from mart.protocol.wire_version import DRIVER_WIRE_VERSION
from mart.sim.room.clutches import Clutch
from mart.sim.room.command_validation import ReceivedCommand
from mart.sim.room.seats import SeatTable
from mart.sim.world.driven_world import ArmReading

SILENT_AFTER_S = 0.1
REPEAT_S = 0.05  # of targets, while no tick fires
_TAKEN_S = 1.0  # for which a driver that was heard keeps its arm
_OLD_S = 0.1


@dataclass(frozen=True)
class ArmFacts:
    """Say what a driver must match: the kind of its arm, its number of joints, and the room's model."""

    kind: str
    joints: int
    model_sha256: str


@dataclass(frozen=True)
class Trouble:
    """Tell what is wrong with an arm, a sentence; driver: what people call its driver."""

    arm: str
    driver: str
    fault: str


@dataclass
class _DriverState:
    facts: ArmFacts
    hello: DriverHello | None = None
    session: int = 0
    newest: ArmMeasured | None = None
    reading: ArmReading | None = None
    read_s: float = 0.0  # when the newest reading was measured
    heard_s: float = 0.0
    excused_s: float = 0.0  # when the room itself had stood still and listened again
    target: ArmTarget = field(default_factory=ArmTarget)
    clutch: Clutch = field(default_factory=Clutch)

    @property
    def called(self) -> str:
        return self.hello.driver if self.hello is not None else ""


class DrivenArms:
    """Hold the arms of one run of a room that drivers drive; send: publishes a target. Times are monotonic seconds."""

    def __init__(
        self, room: str, arms: Mapping[str, ArmFacts], control_hz: float, send: Callable[[ArmTarget], None]
    ) -> None:
        self.rejected: Counter[str] = Counter()
        self._room, self._control_hz, self._send = room, control_hz, send
        self._states = {arm: _DriverState(facts) for arm, facts in arms.items()}
        self._boot_ns = self._sessions = self._sequence = self._tick = 0
        self._watched_s = 0.0
        self._stopped, self._repeat_due_s = True, 0.0

    @property
    def arms(self) -> Sequence[str]:
        """The names of the arms that are driven."""
        return tuple(self._states)

    def begin(self, boot_ns: int, now_s: float) -> None:
        """Begin a run of the sim."""
        self._boot_ns, self._watched_s = boot_ns, now_s
        for state in self._states.values():
            state.excused_s = now_s

    def hello(self, hello: DriverHello, now_s: float) -> DriverReply:
        """Welcome a driver. Raises NotFound, InvalidInput or Conflict where it is refused."""
        state = self._states.get(hello.arm)
        if state is None:
            raise NotFound(
                f"{hello.arm!r} of {self._room} has no driver: {', '.join(self._states) or 'none'} of its arms have."
            )
        _require_match(hello, state.facts, self._room)
        other = state.hello is not None and state.hello.instance != hello.instance
        if other and now_s - state.heard_s < _TAKEN_S:
            raise Conflict(f"{hello.arm} of {self._room} has a driver already: {state.called}.")
        self._sessions += 1
        state.hello, state.session, state.heard_s, state.newest = hello, self._sessions, now_s, None
        state.clutch.stopped()
        return DriverReply(session=state.session, boot=self._boot_ns)

    def hear(self, measured: ArmMeasured, now_s: float) -> None:
        """Take what a driver measured, or count why not."""
        state = self._states.get(measured.arm)
        if state is None or measured.session != state.session or state.session == 0:
            self.rejected["of no session"] += 1
            return
        if state.newest is not None and measured.sequence <= state.newest.sequence:
            self.rejected["old reading"] += 1
            return
        joints = np.array(measured.joint_positions, dtype=np.float64)
        if (
            joints.size not in (0, state.facts.joints)
            or not np.isfinite(joints).all()
            or not 0.0 <= measured.gripper <= 1.0
            or not 0.0 <= measured.age_s < np.inf
        ):
            self.rejected["no reading of this arm"] += 1
            return
        state.newest, state.heard_s = measured, now_s
        if joints.size:
            state.reading, state.read_s = ArmReading(joints, measured.gripper), now_s - measured.age_s

    def reading(self, arm: str) -> ArmReading | None:
        """Return the newest reading of an arm; None before the first."""
        return self._states[arm].reading

    def troubles(self, now_s: float) -> list[Trouble]:
        """Return what is wrong now. Call often: what nobody could hear, because nobody listened, is no silence."""
        if now_s - self._watched_s > REPEAT_S + 0.02:
            for state in self._states.values():
                if (
                    state.excused_s <= state.heard_s
                ):  # once for each silence: who stutters would never hear of any
                    state.excused_s = now_s
        self._watched_s = now_s
        found = ((arm, state, self._fault(state, now_s)) for arm, state in self._states.items())
        return [Trouble(arm, state.called, fault) for arm, state, fault in found if fault]

    def begin_tick(
        self, tick: int, commands: Mapping[str, ReceivedCommand], seats: SeatTable, now_s: float
    ) -> None:
        """Take note of what a tick is stepped with. Who has a clutch is said by the seats, not by commands."""
        self._tick, self._stopped, self._repeat_due_s = tick, False, now_s + REPEAT_S
        for arm, state in self._states.items():
            received = commands.get(arm)
            state.target.engaged = received is not None and state.clutch.engages(
                received.command.engaged, machine=seats[arm].driver.is_machine, now_s=now_s
            )

    def aim(self, arm: str, tool_in_base: Pose, gripper: float) -> None:
        """Send where an arm is to go in the tick that begins, or is to stand after a reset."""
        state = self._states[arm]
        state.target.target_tool_in_base.CopyFrom(pose_message(tool_in_base))
        state.target.gripper = gripper
        self._tell(arm, state)

    def repeat(self, stopped: bool, now_s: float) -> float:
        """Tell the newest targets again where that is due, at once where the room has stopped; return when to call."""
        if not self._states:
            return float("inf")
        if stopped and not self._stopped:
            self._repeat_due_s = now_s
        if stopped:
            for state in self._states.values():
                state.clutch.stopped()
                state.target.engaged = False
        self._stopped = stopped
        if now_s >= self._repeat_due_s:
            self._repeat_due_s = now_s + REPEAT_S
            for arm, state in self._states.items():
                self._tell(arm, state)
        return self._repeat_due_s

    def mark(self, state: State, now_s: float) -> None:
        """Say in a state which of its arms are measured, and how long ago."""
        for arm in state.arms:
            driven = self._states.get(arm.arm)
            if driven is not None:
                arm.measured = True
                arm.measured_age_s = max(0.0, now_s - driven.read_s) if driven.reading is not None else 0.0

    def messages(self, now_s: float) -> list[DrivenArm]:
        """Return how each arm stands, for the room's status."""
        return [
            DrivenArm(
                arm=arm,
                driver=state.called,
                age_s=max(0.0, now_s - state.read_s) if state.reading is not None else 0.0,
                fault=self._fault(state, now_s),
            )
            for arm, state in self._states.items()
        ]

    def _fault(self, state: _DriverState, now_s: float) -> str:
        if state.hello is None:
            return "No driver has connected; start `mart driver` beside its hardware."
        if now_s - max(state.heard_s, state.excused_s) > SILENT_AFTER_S:
            return f"It was silent for {SILENT_AFTER_S:g} s."
        if state.newest is None:
            return "It has not measured anything yet."
        if state.newest.phase == DRIVER_PHASE_STOPPED:
            return state.newest.fault or "It stopped the arm and does not say why."
        if state.newest.age_s > _OLD_S:
            return f"Its readings are {state.newest.age_s:.2f} s old."
        return ""

    def _tell(self, arm: str, state: _DriverState) -> None:
        self._sequence += 1
        target = state.target
        target.room, target.arm, target.boot, target.session = self._room, arm, self._boot_ns, state.session
        target.sequence, target.tick, target.control_hz = self._sequence, self._tick, self._control_hz
        target.stop = self._stopped
        if target.HasField("target_tool_in_base"):
            self._send(target)


def _require_match(hello: DriverHello, facts: ArmFacts, room: str) -> None:
    driver = f"The driver {hello.driver or '?'}"
    if hello.wire_version != DRIVER_WIRE_VERSION:
        raise InvalidInput(
            f"{driver} speaks version {hello.wire_version} of the wire, {room} version {DRIVER_WIRE_VERSION}: install "
            "the same version of MART on both machines."
        )
    if hello.kind != facts.kind or hello.joints != facts.joints:
        raise InvalidInput(
            f"{driver} is of a {hello.kind or '?'} with {hello.joints} joints; {hello.arm} of {room} is a "
            f"{facts.kind} with {facts.joints}."
        )
    if hello.model_sha256 != facts.model_sha256:
        raise InvalidInput(
            f"{driver} computes by another model than {room} has: it was started anew meanwhile, or is of another "
            "version of MART."
        )
