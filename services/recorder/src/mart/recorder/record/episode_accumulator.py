"""Gather what one episode was from its states, events and statuses, for its metadata records at the end. Pure.

The recorder adds messages as they arrive and repair adds those that a crash has left: same code, same records.

How an episode ended is said by one event, which may be lost. So it is learned from whatever says it: the event, the
room's status, which is repeated, or, where nobody said anything, the last state itself.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from mart.episodes.steady_time import SteadyTime
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_STOPPED,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OUTCOME_UNSPECIFIED,
    ArmState,
    Command,
    Event,
    RoomStatus,
    State,
    ended_by_word,
    operator_word,
    outcome_word,
)
from mart.protocol.recording import WORLD_OF_DRIVERS, CadenceRecord, EpisodeRecord, OperatorsRecord, Shift
from mart.recorder.record.command_ledger import CommandLedger
from mart.recorder.record.episode_ending import EpisodeEnding, ending_of
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.record.tick_clock import TickClock

_UNPACED_HZ = 5000.0  # no machine ticks faster
_SLACK_S = 2.0
_TICKS_AHEAD = 10


class EpisodeAccumulator:
    """Gather one episode of one run of a room's sim, from its first recorded state on."""

    def __init__(self, first: State) -> None:
        self.room = first.room
        self.number = first.episode
        self.boot = first.boot
        self.arms = tuple(arm.arm for arm in first.arms)
        self.ended: EpisodeEnding | None = None
        self.unfinished_reason = "the episode was not finished"
        self.interrupted = False
        self.seed: int | None = None
        self.started: Event.EpisodeStarted | None = None
        self.states = 0
        self.missing_ticks = 0
        self.video_dropped = 0
        self.messages_lost = 0
        self._commands = CommandLedger()
        self._first = self._last = first
        self._clock, self._sent = TickClock(), SteadyTime()
        self._ended_ns = first.stamps.sent_ns
        self._waited_s: dict[str, float] = defaultdict(float)
        self._latency: dict[str, Event.Latency] = {}
        self._shifts: dict[str, list[tuple[int, int, ArmState]]] = defaultdict(list)  # (tick, epoch, arm)

    @property
    def started_ns(self) -> int:
        """Tell when the room sent the first state (Unix time)."""
        return self._first.stamps.sent_ns

    @property
    def first_tick(self) -> int:
        """The room's tick of the first state."""
        return self._first.tick

    @property
    def last_tick(self) -> int:
        """The room's tick of the newest state."""
        return self._last.tick

    @property
    def is_glimpse(self) -> bool:
        """Whether it is one state and no tick: what a recorder sees that comes when the episode is over."""
        return self.states == 1 and self._first.episode_tick > 0

    @property
    def has_all(self) -> bool:
        """Whether the outcome is known and its last state has arrived."""
        return self.ended is not None and self._last.tick >= self.ended.last_tick

    @property
    def missing_commands(self) -> int:
        """How many commands its states name that have not come."""
        return self._commands.missing

    def awaits(self, arm: str, command: Command) -> bool:
        """Tell whether a state names this command and it has not come."""
        return self._commands.awaits(arm, command)

    def add_command(self, arm: str, command: Command) -> None:
        """Take a command for an arm that is written into the file."""
        self._commands.add_command(arm, command)

    def belongs(self, state: State) -> bool:
        """Tell whether a state is one of this episode."""
        return state.boot == self.boot and state.episode == self.number

    def require_near(self, state: State, elapsed_s: float) -> None:
        """Raise InvalidInput where a state of this episode leaps beyond what `elapsed_s` since the newest permits."""
        paced = self.started is not None and not self.started.lockstep and self.started.control_hz > 0
        most_hz = self.started.control_hz if self.started is not None and paced else _UNPACED_HZ
        permitted = _TICKS_AHEAD + (elapsed_s + _SLACK_S) * most_hz
        began = self._first.tick - self._first.episode_tick
        if state.tick - self._last.tick > permitted or state.tick - state.episode_tick != began:
            raise InvalidInput(
                f"A state of tick {state.tick} came {elapsed_s:.1f} s after that of tick {self._last.tick}, "
                f"in an episode that began at tick {began}."
            )

    def add_state(self, state: State, arrived_ns: int) -> bool:
        """Add a state, and tell whether it is news: one that repeats or precedes the newest is not.

        arrived_ns: when it came (Unix time), told by a clock that was not set meanwhile.
        """
        if self.states and state.tick <= self._last.tick:
            return False
        if self.states:
            self.missing_ticks += state.tick - self._last.tick - 1
            self._commands.add_state(state)
        self.states += 1
        self._last = state
        self._clock.add(state, arrived_ns)
        self._ended_ns = self._sent.steady_ns(state.stamps.sent_ns, arrived_ns)
        if state.straggler and np.isfinite(state.straggler_late_s):
            self._waited_s[state.straggler] += state.straggler_late_s
        for arm in state.arms:
            self._add_arm(state, arm)
        return True

    def add_event(self, event: Event) -> None:
        """Learn what an event says of this episode."""
        if event.HasField("episode_started") and event.episode_started.number == self.number:
            self.started, self.seed = event.episode_started, event.episode_started.seed
        elif event.HasField("episode_ended") and event.episode_ended.number == self.number:
            self.ended = EpisodeEnding.of(event.episode_ended, event.episode_ended.last_tick)
        elif event.HasField("barrier_changed"):
            self.interrupted |= event.barrier_changed.phase in (BARRIER_PHASE_PAUSED, BARRIER_PHASE_STOPPED)
        elif event.HasField("latency") and _is_usable(event.latency) and event.latency.arm in self.arms:
            self._latency[event.latency.arm] = event.latency

    def add_status(self, status: RoomStatus) -> None:
        """Learn what a room's status says of this episode; being repeated, it makes up for an event that was lost."""
        said = status.episode
        if status.boot != self.boot:
            return
        last = status.last_ended
        if last.number == self.number and self.ended is None and last.outcome != OUTCOME_UNSPECIFIED:
            self.ended = EpisodeEnding.of(last, last.last_tick)
        if said.number != self.number:
            return
        if said.phase not in (EPISODE_PHASE_RECORDING, EPISODE_PHASE_ENDED):
            return
        self.interrupted |= said.interrupted
        self.seed = said.seed if self.seed is None else self.seed
        if said.phase == EPISODE_PHASE_ENDED and self.ended is None and said.outcome != OUTCOME_UNSPECIFIED:
            last_tick = self._first.tick - self._first.episode_tick + said.ticks
            self.ended = EpisodeEnding.of(said, last_tick)

    def is_past(self, status: RoomStatus) -> bool:
        """Tell whether the room has gone on: it practises again after this episode, or is at a later one."""
        said = status.episode
        practises = said.number == self.number and said.phase == EPISODE_PHASE_PRACTICE
        return status.boot == self.boot and (practises or said.number > self.number)

    def conclude(self, unfinished_reason: str) -> None:
        """Decide how it ended where nobody said so: by its last state, else it is unfinished for this reason."""
        self.unfinished_reason = unfinished_reason
        if self.ended is None:
            self.ended = ending_of(self._last, self.started)

    def record(self, facts: RoomFacts, repaired: bool = False) -> EpisodeRecord:
        """Return the record `mart.episode`. repaired: whether it is put together from what a crash had left."""
        started, ended = self.started, self.ended
        subtasks = [subtask.done for subtask in self._last.progress.subtasks]
        measured = tuple(arm.arm for arm in self._last.arms if arm.measured)
        return EpisodeRecord(
            room=self.room,
            number=self.number,
            task=facts.task,
            control_hz=facts.control_hz,
            arms=self.arms,
            arm_kinds=facts.arm_kinds,
            world=WORLD_OF_DRIVERS if measured else None,
            measured_arms=measured or None,
            captured_cameras=tuple(started.captured_cameras) or None if started else None,
            seed=self.seed,
            mode=started and ("lockstep" if started.lockstep else "live"),
            skill=(started and started.skill) or None,
            time_limit_s=(started and started.time_limit_s) or None,
            started_ns=self._first.stamps.sent_ns,
            ended_ns=self._ended_ns,
            ticks=self.states - 1,
            first_tick=self._first.tick,
            last_tick=self._last.tick,
            outcome=outcome_word(ended.outcome if ended else OUTCOME_UNSPECIFIED),
            reason=ended.reason if ended else self.unfinished_reason,
            ended_by=ended_by_word(ended.ended_by) if ended else None,
            ended_by_name=(ended and ended.ended_by_name) or None,
            ended_by_arm=(ended and ended.ended_by_arm) or None,
            subtasks_done=sum(subtasks) if subtasks else None,
            subtasks=len(subtasks) or None,
            interrupted=self.interrupted,
            complete=self.has_all and not self.missing_ticks and self._first.episode_tick == 0,
            repaired=repaired,
        )

    def cadence(self) -> CadenceRecord:
        """Return the record `mart.cadence`."""
        return self._clock.cadence(
            missing_ticks=self.missing_ticks,
            missing_commands=self.missing_commands,
            waited_s=float(sum(self._waited_s.values())),
            waited_for_s={arm: self._waited_s.get(arm, 0.0) for arm in self.arms},
            motion_to_photon_p50_ms={arm: latency.p50_ms for arm, latency in self._latency.items()},
            motion_to_photon_p95_ms={arm: latency.p95_ms for arm, latency in self._latency.items()},
            video_dropped=self.video_dropped,
            messages_lost=self.messages_lost,
        )

    def operators(self, facts: RoomFacts) -> OperatorsRecord:
        """Return the record `mart.operators`; names are those that the room has told."""

        def shift(tick: int, epoch: int, arm: ArmState) -> Shift:
            name = facts.names.get((arm.arm, epoch), "")
            return Shift(episode_tick=tick, operator=operator_word(arm.source), name=name)

        return OperatorsRecord(
            shifts={arm: tuple(shift(*entry) for entry in entries) for arm, entries in self._shifts.items()}
        )

    def _add_arm(self, state: State, arm: ArmState) -> None:
        shifts = self._shifts[arm.arm]
        if not shifts or (shifts[-1][1], shifts[-1][2].source) != (arm.seat_epoch, arm.source):
            shifts.append((state.episode_tick, arm.seat_epoch, arm))


def _is_usable(latency: Event.Latency) -> bool:
    return bool(np.isfinite([latency.p50_ms, latency.p95_ms]).all())
