"""A live room's way out to the bus."""

from __future__ import annotations

from mart.protocol import clock, codec, keys
from mart.protocol.messages import Event, RoomStatus, State
from mart.runtime.bus import Bus


class BusPublisher:
    """Speaks on the keys of a room."""

    def __init__(self, bus: Bus, room: str) -> None:
        self._state = bus.publisher(keys.state(room))
        self._status = bus.publisher(keys.status(room))
        self._event = bus.publisher(keys.event(room))
        self._newest = b""

    def state(self, state: State) -> None:
        state.stamps.sent_ns = clock.wall_ns()
        self._newest = codec.encode(state)
        self._state.put(self._newest)

    def repeat_state(self) -> None:
        self._state.put(self._newest)

    def status(self, status: RoomStatus) -> None:
        self._status.put(codec.encode(status))

    def event(self, event: Event) -> None:
        self._event.put(codec.encode(event))

    def close(self) -> None:
        for publisher in (self._state, self._status, self._event):
            publisher.close()
