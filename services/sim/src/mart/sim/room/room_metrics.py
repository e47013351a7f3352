"""Show how a room does, from what it says anyway: its states and its status, on their way to the bus."""

from __future__ import annotations

from prometheus_client import Counter, Gauge, Summary

from mart.protocol.enum_words import barrier_word, operator_word
from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    BARRIER_PHASE_STOPPED,
    Event,
    RoomStatus,
    State,
)
from mart.protocol.vocabulary import OperatorKind
from mart.runtime.metrics import REGISTRY
from mart.sim.room.room_publisher import RoomPublisher

_ROOM = ("room",)
_ARM = ("room", "arm")

REAL_TIME_FACTOR = Gauge(
    "mart_room_real_time_factor",
    "Simulated over wall time of about the last 2 s, at most 1; 1 where the world stands on purpose.",
    _ROOM,
    registry=REGISTRY,
)
CONTROL_RATE = Gauge("mart_room_control_rate_hertz", "Ticks a second, at most.", _ROOM, registry=REGISTRY)
STATES = Counter("mart_room_states", "States that were told: ticks and resets.", _ROOM, registry=REGISTRY)
STEP = Summary("mart_room_step_seconds", "What the physics of a tick took.", _ROOM, registry=REGISTRY)
BARRIER_WAIT = Counter(
    "mart_room_barrier_wait_seconds",
    "For how long ticks that were due waited for this arm's command, which came last.",
    _ARM,
    registry=REGISTRY,
)
SILENCE = Gauge(
    "mart_room_silence_seconds",
    "For how long the room waits for this arm now; 0: not.",
    _ARM,
    registry=REGISTRY,
)
PHASE = Gauge(
    "mart_room_barrier_phase",
    "1 for the phase of the barrier that holds: running, stalled, paused or stopped.",
    ("room", "phase"),
    registry=REGISTRY,
)
REJECTED = Counter(
    "mart_room_rejected_commands",
    "Commands that were not used, for whatever reason.",
    _ROOM,
    registry=REGISTRY,
)
SEATS = Gauge("mart_room_seats", "Seats by who drives them.", ("room", "operator"), registry=REGISTRY)
UNRECORDED = Gauge(
    "mart_room_unrecorded", "1 while nobody keeps the episode that goes on, else 0.", _ROOM, registry=REGISTRY
)
EPISODES_SAVED = Gauge(
    "mart_room_episodes_saved",
    "Episodes that were saved, by whether they count.",
    ("room", "good"),
    registry=REGISTRY,
)
CAMERA_DARK = Gauge(
    "mart_room_camera_dark_seconds",
    "For how long a real camera has given no picture; 0: it gives some.",
    ("room", "camera"),
    registry=REGISTRY,
)

_PHASES = tuple(
    barrier_word(phase)
    for phase in (
        BARRIER_PHASE_RUNNING,
        BARRIER_PHASE_STALLED,
        BARRIER_PHASE_PAUSED,
        BARRIER_PHASE_STOPPED,
    )
)


class MeteredPublisher:
    """Publish what a room says, and take its figures from it."""

    def __init__(self, publisher: RoomPublisher, room: str, arms: tuple[str, ...]) -> None:
        self._publisher, self._room = publisher, room
        self._states, self._step = STATES.labels(room), STEP.labels(room)
        self._waits = {arm: BARRIER_WAIT.labels(room, arm) for arm in arms}
        self._rejected = 0

    def state(self, state: State) -> None:
        """Publish a state."""
        self._publisher.state(state)
        self._states.inc()
        self._step.observe((state.stamps.stepped_ns - state.stamps.fired_ns) * 1e-9)
        if state.straggler in self._waits:
            self._waits[state.straggler].inc(state.straggler_late_s)

    def repeat_state(self) -> None:
        """Publish the newest state once more."""
        self._publisher.repeat_state()

    def status(self, status: RoomStatus) -> None:
        """Publish how the room stands."""
        self._publisher.status(status)
        room = self._room
        REAL_TIME_FACTOR.labels(room).set(status.real_time_factor)
        CONTROL_RATE.labels(room).set(status.control_hz)
        UNRECORDED.labels(room).set(bool(status.unrecorded))
        EPISODES_SAVED.labels(room, "yes").set(status.episodes_good)
        EPISODES_SAVED.labels(room, "no").set(status.episodes_saved - status.episodes_good)
        # A room that is opened anew at another rate counts from where the one before it stood, or from 0.
        REJECTED.labels(room).inc(max(0, status.rejected_commands - self._rejected))
        self._rejected = status.rejected_commands
        holds = barrier_word(status.barrier)
        for phase in _PHASES:
            PHASE.labels(room, phase).set(phase == holds)
        silent_s = {one.arm: one.since_s for one in status.waiting_for}
        for arm in self._waits:
            SILENCE.labels(room, arm).set(silent_s.get(arm, 0.0))
        operators = [operator_word(seat.operator) for seat in status.seats]
        for operator in OperatorKind:
            SEATS.labels(room, operator).set(operators.count(operator))
        for camera in status.cameras:
            CAMERA_DARK.labels(room, camera.camera).set(camera.dark_s if camera.dark else 0.0)

    def event(self, event: Event) -> None:
        """Publish what has just happened."""
        self._publisher.event(event)
