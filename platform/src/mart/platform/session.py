"""A collection session of a seated crew: episode after episode, from ready to the saved file."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mart.platform.crew import Person
from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.errors import Unavailable
from mart.protocol.messages import EPISODE_PHASE_PRACTICE, Event, RoomStatus, outcome_word
from mart.runtime.bus.base import Bus, Sample

_EPISODE_TIMEOUT_S = 120.0
_SAVE_TIMEOUT_S = 60.0


@dataclass(frozen=True)
class Episode:
    """One recorded episode. Motion to photon is None where no page was watching."""

    number: int
    seed: int
    skill: str
    path: str
    outcome: str
    reason: str
    ticks: int
    simulated_s: float
    real_time_factor: float
    verified: bool
    verdict: str
    latencies: tuple[Event.Latency, ...]

    def as_json(self) -> dict[str, Any]:
        worst = max(self.latencies, key=lambda latency: latency.p95_ms, default=None)
        return {
            "path": self.path,
            "outcome": self.outcome,
            "reason": self.reason,
            "skill": self.skill or None,
            "seed": self.seed,
            "ticks": self.ticks,
            "simulated_s": round(self.simulated_s, 3),
            "real_time_factor": round(self.real_time_factor, 4),
            "motion_to_photon_p50_ms": round(worst.p50_ms, 1) if worst else None,
            "motion_to_photon_p95_ms": round(worst.p95_ms, 1) if worst else None,
            "motion_to_photon": {latency.arm: _latency_json(latency) for latency in self.latencies},
            "verified": self.verified,
            "verdict": self.verdict,
        }


class Session:
    """Listens to a room's events from the first moment, so that none is missed between two calls."""

    def __init__(self, bus: Bus, room: str) -> None:
        self._events: queue.Queue[Event] = queue.Queue()
        self._latest_latency: dict[str, Event.Latency] = {}
        self._practising = threading.Event()
        self._subscriptions = [
            bus.subscribe(keys.event(room).key, self._on_event),
            bus.subscribe(keys.status(room).key, self._on_status),
        ]
        self._room = room

    def run_episode(self, people: Sequence[Person]) -> Episode:
        """Everyone says ready; returns when the file is on disk.

        Raises Unavailable where no episode starts, ends or is saved in time.
        """
        if not self._practising.wait(_EPISODE_TIMEOUT_S):
            raise Unavailable(
                f"{self._room} is not in practice after {_EPISODE_TIMEOUT_S:g} s; is its sim up?"
            )
        self._latest_latency.clear()
        for person in people:
            person.visitor.act(self._room, person.arm, "ready")
        started = self._await("episode_started", _EPISODE_TIMEOUT_S)
        ended = self._await("episode_ended", _EPISODE_TIMEOUT_S)
        saved = self._await("episode_saved", _SAVE_TIMEOUT_S)
        latencies = tuple(latency for _, latency in sorted(self._latest_latency.items()))
        return episode_of(started, ended, saved.episode_saved, latencies)

    def close(self) -> None:
        for subscription in self._subscriptions:
            subscription.close()

    def _on_status(self, sample: Sample) -> None:
        practising = decode(RoomStatus, sample.payload).episode.phase == EPISODE_PHASE_PRACTICE
        (self._practising.set if practising else self._practising.clear)()

    def _on_event(self, sample: Sample) -> None:
        self._events.put(decode(Event, sample.payload))

    def _await(self, what: str, timeout_s: float) -> Event:
        with contextlib.suppress(queue.Empty):
            while True:
                event = self._events.get(timeout=timeout_s)
                if event.WhichOneof("what") == what:
                    return event
                if event.HasField("latency"):
                    self._latest_latency[event.latency.arm] = event.latency
        raise Unavailable(
            f"{self._room} sent no {what.replace('_', ' ')} within {timeout_s:g} s; `mart rooms` tells why."
        )


def episode_of(
    started: Event, ended: Event, saved: Event.EpisodeSaved, latencies: tuple[Event.Latency, ...] = ()
) -> Episode:
    """What three events tell together."""
    began, over = started.episode_started, ended.episode_ended
    wall_s = (ended.wall_ns - started.wall_ns) / 1e9
    return Episode(
        number=over.number,
        seed=began.seed,
        skill=began.skill,
        path=saved.path,
        outcome=outcome_word(over.outcome),
        reason=over.reason,
        ticks=over.ticks,
        simulated_s=over.ticks / began.control_hz,
        # The first tick fires at once, so n ticks last n - 1 periods.
        real_time_factor=(over.ticks - 1) / began.control_hz / wall_s,
        verified=saved.verified,
        verdict=saved.verdict,
        latencies=latencies,
    )


def _latency_json(latency: Event.Latency) -> dict[str, Any]:
    return {
        "p50_ms": round(latency.p50_ms, 1),
        "p95_ms": round(latency.p95_ms, 1),
        "frames": latency.frames,
        "stages_p50_ms": {stage.name: round(stage.p50_ms, 2) for stage in latency.stages},
    }
