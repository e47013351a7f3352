"""What one episode was: a pure fold over its states and events, asked for its metadata records at the end.

The recorder folds messages as they arrive and repair folds those that a crash has left: same code, same records.
"""

from __future__ import annotations

import re
from array import array
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_STOPPED,
    OUTCOME_UNSPECIFIED,
    ArmState,
    Event,
    Model,
    RoomStatus,
    Seat,
    State,
    operator_word,
    outcome_word,
)
from mart.protocol.recording import CadenceRecord, EpisodeRecord, OperatorsRecord, RoomRecord, Shift

_TASK_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")
_MAX_NAMES = 1024  # seats change hands; the oldest names are forgotten


@dataclass
class RoomFacts:
    """What is known about a room besides its states. Learned from whatever says it first."""

    room: str
    task: str | None = None
    control_hz: float | None = None
    model_sha256: str | None = None
    mujoco_version: str | None = None
    names: dict[tuple[str, int], str] = field(default_factory=dict)  # (arm, seat epoch) → who

    def learn_status(self, status: RoomStatus) -> None:
        self._learn_task(status.task, status.control_hz)
        self._learn_seats(status.seats)

    def learn_event(self, event: Event) -> None:
        if event.HasField("episode_started"):
            started = event.episode_started
            self._learn_task(started.task, started.control_hz)
            self._learn_seats(started.seats)
            self.model_sha256 = started.model_sha256 or self.model_sha256
        elif event.HasField("seat_changed"):
            self._learn_seats([event.seat_changed])

    def learn_model(self, model: Model) -> None:
        self._learn_task(model.task, model.control_hz)
        self.model_sha256, self.mujoco_version = model.sha256, model.mujoco_version

    def learn_record(self, record: RoomRecord) -> None:
        self._learn_task(record.task or "", record.control_hz or 0.0)
        self.model_sha256 = record.model_sha256 or self.model_sha256
        self.mujoco_version = record.mujoco_version or self.mujoco_version

    @property
    def is_complete(self) -> bool:
        """Whether enough is known to step the room's world again."""
        return bool(self.task and self.control_hz and self.model_sha256)

    def record(self) -> RoomRecord:
        return RoomRecord(
            room=self.room,
            task=self.task,
            control_hz=self.control_hz,
            model_sha256=self.model_sha256,
            mujoco_version=self.mujoco_version,
        )

    def _learn_task(self, task: str, control_hz: float) -> None:
        if _TASK_NAME.fullmatch(task):  # it becomes part of a file's name
            self.task = task
        if np.isfinite(control_hz) and control_hz > 0:
            self.control_hz = control_hz

    def _learn_seats(self, seats: Iterable[Seat]) -> None:
        for seat in seats:
            self.names[seat.arm, seat.epoch] = seat.name
        while len(self.names) > _MAX_NAMES:
            del self.names[next(iter(self.names))]


class EpisodeAccumulator:
    """One episode of one run of a room's sim, from its first recorded state on."""

    def __init__(self, first: State) -> None:
        self.room = first.room
        self.number = first.episode
        self.boot = first.boot
        self.arms = tuple(arm.arm for arm in first.arms)
        self.ended: Event.EpisodeEnded | None = None
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
        return self._first.stamps.sent_ns

    @property
    def last_tick(self) -> int:
        return self._last.tick

    @property
    def is_glimpse(self) -> bool:
        """One state and no tick: what a recorder sees that comes when the episode is over (rooms repeat states)."""
        return self.states == 1 and self._first.episode_tick > 0

    @property
    def has_all(self) -> bool:
        """Whether the outcome is known and its last state has arrived."""
        return self.ended is not None and self._last.tick >= self.ended.last_tick

    def belongs(self, state: State) -> bool:
        return state.boot == self.boot and state.episode == self.number

    def add_state(self, state: State) -> bool:
        """Whether the state is news: one that repeats or precedes the newest is not."""
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
        if event.HasField("episode_started") and event.episode_started.number == self.number:
            self.started, self.seed = event.episode_started, event.episode_started.seed
        elif event.HasField("episode_ended") and event.episode_ended.number == self.number:
            self.ended = event.episode_ended
        elif event.HasField("barrier_changed"):
            self.interrupted |= event.barrier_changed.phase in (BARRIER_PHASE_PAUSED, BARRIER_PHASE_STOPPED)
        elif event.HasField("latency") and _is_usable(event.latency) and event.latency.arm in self.arms:
            self._latency[event.latency.arm] = event.latency

    def add_status(self, status: RoomStatus) -> None:
        if status.boot == self.boot and status.episode.number == self.number:
            self.interrupted |= status.episode.interrupted
            self.seed = status.episode.seed if self.seed is None else self.seed

    def record(self, facts: RoomFacts, repaired: bool = False) -> EpisodeRecord:
        started, ended = self.started, self.ended
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
            interrupted=self.interrupted,
            complete=self.has_all and not self.missing_ticks and self._first.episode_tick == 0,
            repaired=repaired,
        )

    def cadence(self) -> CadenceRecord:
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


class _TickClock:
    """When ticks fired. The first state of an episode is a reset and no tick, so it does not count."""

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
