"""What goes on in rooms, for a service that drives seats in them."""

from __future__ import annotations

import threading
from collections import Counter, deque
from collections.abc import Mapping, Sequence
from typing import TypeVar

from mart.protocol import keys
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Event, RoomStatus, State
from mart.protocol.received import decode_received
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Sample

_MAX_STATUS_BYTES = 64 * 1024
_MAX_STATE_BYTES = 1024 * 1024
_MAX_EVENT_BYTES = 64 * 1024
_MAX_EVENTS = 64  # between two looks; older ones are dropped

M = TypeVar("M", RoomStatus, State, Event)


class RoomWatch:
    """The newest status and state of every room, or of `room` alone, and its cues. Whoever is late misses older ones.

    `unusable` counts what could not be decoded.
    """

    def __init__(self, bus: Bus, room: str | None = None) -> None:
        self.unusable: Counter[str] = Counter()
        self._states: dict[str, bytes] = {}
        self._statuses: dict[str, bytes] = {}
        self._gone: set[str] = set()
        self._events: deque[tuple[str, bytes]] = deque(maxlen=_MAX_EVENTS)
        self._arrived = threading.Condition()
        self._subscriptions = (
            bus.subscribe(keys.status(room).key if room else keys.EVERY_STATUS, self._on_status),
            bus.subscribe(keys.state(room).key if room else keys.EVERY_STATE, self._on_state),
            bus.subscribe(keys.event(room).key if room else keys.EVERY_EVENT, self._on_event),
            bus.watch(keys.alive_of(ServiceKind.SIM), self._on_sim),
        )

    def take(self, timeout_s: float) -> tuple[Mapping[str, RoomStatus], Mapping[str, State]]:
        """Return, by room, what came since the last call; wait for something at most `timeout_s`."""
        with self._arrived:
            if not self._statuses and not self._states:
                self._arrived.wait(timeout_s)
            statuses, states = self._statuses, self._states
            self._statuses, self._states = {}, {}
        return (
            self._decoded(RoomStatus, statuses, _MAX_STATUS_BYTES),
            self._decoded(State, states, _MAX_STATE_BYTES),
        )

    def cues(self) -> Sequence[tuple[str, Event]]:
        """Return, in the order in which they came, the rooms and events of the cues given since the last call."""
        with self._arrived:
            events = tuple(self._events)
            self._events.clear()
        decoded = (
            (room, event)
            for room, payload in events
            for event in self._decoded(Event, {room: payload}, _MAX_EVENT_BYTES).values()
        )
        return [(room, event) for room, event in decoded if event.HasField("cue_given")]

    def is_gone(self, room: str) -> bool:
        """Whether the room's sim had a liveliness token and has none now."""
        with self._arrived:
            return room in self._gone

    def forget(self, room: str) -> None:
        """Forget that a room is gone."""
        with self._arrived:
            self._gone.discard(room)

    def close(self) -> None:
        for subscription in self._subscriptions:
            subscription.close()

    def _on_sim(self, key: str, alive: bool) -> None:
        with self._arrived:
            (self._gone.discard if alive else self._gone.add)(keys.last_of(key))

    def _on_status(self, sample: Sample) -> None:
        with self._arrived:
            self._statuses[keys.room_of(sample.key)] = sample.payload
            self._arrived.notify()

    def _on_state(self, sample: Sample) -> None:
        with self._arrived:
            self._states[keys.room_of(sample.key)] = sample.payload
            self._arrived.notify()

    def _on_event(self, sample: Sample) -> None:
        with self._arrived:  # nobody is woken: what obeys acts on the next state
            self._events.append((keys.room_of(sample.key), sample.payload))

    def _decoded(self, kind: type[M], payloads: Mapping[str, bytes], limit_bytes: int) -> dict[str, M]:
        decoded: dict[str, M] = {}
        for room, payload in payloads.items():
            try:
                decoded[room] = decode_received(kind, payload, limit_bytes)
            except InvalidInput as error:
                self.unusable[f"{room}: {error}"] += 1
        return decoded
