"""Gather what one episode was from its states, events and statuses, for its metadata records at the end. Pure.

The recorder adds messages as they arrive and repair adds those that a crash has left: same code, same records.

How an episode ended is said by one event, which may be lost. So it is learned from whatever says it: the event, the
room's status, which is repeated, or, where nobody said anything, the last state itself.
"""

from __future__ import annotations

from array import array
from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_STOPPED,
    ENDED_BY_TASK,
    ENDED_BY_TIME,
    ENDED_BY_UNSPECIFIED,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    OUTCOME_UNSPECIFIED,
    ArmState,
    EndedBy,
    Episode,
    Event,
    Outcome,
    RoomStatus,
    State,
    ended_by_word,
    operator_word,
    outcome_word,
)
from mart.protocol.recording import CadenceRecord, EpisodeRecord, OperatorsRecord, Shift
from mart.recorder.record.room_facts import RoomFacts


@dataclass(frozen=True)
class EpisodeEnding:
    """Say how an episode ended, with which tick of its room, and who or what ended it."""

    outcome: Outcome
    reason: str
    last_tick: int
    ended_by: EndedBy = ENDED_BY_UNSPECIFIED
    ended_by_name: str = ""
    ended_by_arm: str = ""

    @classmethod
    def of(cls, said: Event.EpisodeEnded | Episode, last_tick: int) -> EpisodeEnding:
        """Return what a room has said, in an event or in its status."""
        return cls(said.outcome, said.reason, last_tick, said.ended_by, said.ended_by_name, said.ended_by_arm)


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
        self._first = self._last = first
        self._clock = _TickClock()
        self._waited_s: dict[str, float] = defaultdict(float)
        self._latency: dict[str, Event.Latency] = {}
        self._shifts: dict[str, list[tuple[int, int, ArmState]]] = defaultdict(list)  # (tick, epoch, arm)

    @property
    def started_ns(self) -> int:
        """Tell when the room sent the first state (Unix time)."""
        return self._first.stamps.sent_ns

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

    def belongs(self, state: State) -> bool:
        """Tell whether a state is one of this episode."""
        return state.boot == self.boot and state.episode == self.number

    def add_state(self, state: State) -> bool:
        """Add a state, and tell whether it is news: one that repeats or precedes the newest is not."""
        if self.states and state.tick <= self._last.tick:
            return False
        if self.states:
            self.missing_ticks += state.tick - self._last.tick - 1
        self.states += 1
        self._last = state
        self._clock.add(state)
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
            self.ended = _ending_of(self._last, self.started)

    def record(self, facts: RoomFacts, repaired: bool = False) -> EpisodeRecord:
        """Return the record `mart.episode`. repaired: whether it is put together from what a crash had left."""
        started, ended = self.started, self.ended
        subtasks = [subtask.done for subtask in self._last.progress.subtasks]
        return EpisodeRecord(
            room=self.room,
            number=self.number,
            task=facts.task,
            control_hz=facts.control_hz,
            arms=self.arms,
            seed=self.seed,
            mode=started and ("lockstep" if started.lockstep else "live"),
            skill=(started and started.skill) or None,
            time_limit_s=(started and started.time_limit_s) or None,
            started_ns=self._first.stamps.sent_ns,
            ended_ns=self._last.stamps.sent_ns,
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


def _ending_of(last: State, started: Event.EpisodeStarted | None) -> EpisodeEnding | None:
    """Return the ending that a last state implies: a room ends an episode at the tick on which its task is decided."""
    if last.progress.success:
        return EpisodeEnding(OUTCOME_SUCCESS, "the task is done", last.tick, ENDED_BY_TASK)
    if last.progress.failed:
        return EpisodeEnding(OUTCOME_FAILURE, last.progress.failed, last.tick, ENDED_BY_TASK)
    limit_ticks = round(started.time_limit_s * started.control_hz) if started is not None else 0
    if limit_ticks and last.episode_tick >= limit_ticks:
        return EpisodeEnding(OUTCOME_FAILURE, "time is up", last.tick, ENDED_BY_TIME)
    return None


def _is_usable(latency: Event.Latency) -> bool:
    return bool(np.isfinite([latency.p50_ms, latency.p95_ms]).all())


class _TickClock:
    """Keep when ticks fired. The first state of an episode is a reset and no tick, so it does not count."""

    def __init__(self) -> None:
        self._fired_ns = array("Q")
        self._sim_s = array("d")

    def add(self, state: State) -> None:
        if state.episode_tick > 0 and state.stamps.fired_ns:
            self._fired_ns.append(state.stamps.fired_ns)
            self._sim_s.append(state.sim_time_s)

    def cadence(self, **known: object) -> CadenceRecord:
        if len(self._fired_ns) < 2:
            return CadenceRecord(wall_s=0.0, sim_s=0.0, **known)
        fired_ns = np.array(self._fired_ns, dtype=np.int64)
        intervals_ms = np.diff(fired_ns) / 1e6
        wall_s = float(fired_ns[-1] - fired_ns[0]) / 1e9
        sim_s = self._sim_s[-1] - self._sim_s[0]
        return CadenceRecord(
            real_time_factor=sim_s / wall_s if wall_s > 0 else None,
            wall_s=wall_s,
            sim_s=sim_s,
            tick_interval_p50_ms=float(np.percentile(intervals_ms, 50)),
            tick_interval_p95_ms=float(np.percentile(intervals_ms, 95)),
            tick_interval_max_ms=float(intervals_ms.max()),
            **known,
        )
