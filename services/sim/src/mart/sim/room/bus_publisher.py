"""Publish what a room says on the bus: a live one newest first, an unpaced one in order."""

from __future__ import annotations

from mart.protocol import clock, codec, keys
from mart.protocol.messages import Event, RoomStatus, State
from mart.runtime.bus import Bus
from mart.sim.room.room_publisher import STATUS_S


class BusPublisher:
    """Publish what a live room says on its keys."""

    def __init__(self, bus: Bus, room: str) -> None:
        self._state = bus.publisher(keys.state(room))
        self._status = bus.publisher(keys.status(room))
        self._event = bus.publisher(keys.event(room))
        self._newest = b""

    def state(self, state: State) -> None:
        """Publish a state, stamped with when it was sent."""
        state.stamps.sent_ns = clock.wall_ns()
        self._newest = codec.encode(state)
        self._state.put(self._newest)

    def repeat_state(self) -> None:
        """Publish the newest state once more, the very same bytes."""
        self._state.put(self._newest)

    def status(self, status: RoomStatus) -> None:
        """Publish the room's status."""
        self._status.put(codec.encode(status))

    def event(self, event: Event) -> None:
        """Publish an event."""
        self._event.put(codec.encode(event))

    def close(self) -> None:
        """Close the room's publishers."""
        for publisher in (self._state, self._status, self._event):
            publisher.close()


class OrderedPublisher:
    """Publish what an unpaced room says, in order and without loss; `newest` is the state that was told last."""

    def __init__(self, bus: Bus, room: str, arms: tuple[str, ...]) -> None:
        self.newest = State()
        self._state = bus.publisher(keys.in_order(keys.state(room)))
        self._event = bus.publisher(keys.in_order(keys.event(room)))
        self._commands = {arm: bus.publisher(keys.in_order(keys.command(room, arm))) for arm in arms}
        self._status = bus.publisher(keys.status(room))
        self._status_due_s = self._began_s = clock.monotonic_s()
        self._real_time_factor = 1.0

    def state(self, state: State) -> None:
        """Publish a state with the real time factor: the room keeps simulated time, so it is measured here."""
        if state.sim_time_s > 0.0:
            self._real_time_factor = state.sim_time_s / (clock.monotonic_s() - self._began_s)
        else:
            self._began_s = clock.monotonic_s()
        state.real_time_factor = self._real_time_factor
        state.stamps.sent_ns = clock.wall_ns()
        self.newest = state
        self._state.put(codec.encode(state))

    def repeat_state(self) -> None:
        """Do nothing: nobody who comes late to an episode could follow it."""

    def status(self, status: RoomStatus) -> None:
        """Publish the status as often as a live room says it, in real time."""
        if clock.monotonic_s() >= self._status_due_s:
            self._status_due_s = clock.monotonic_s() + STATUS_S
            status.real_time_factor = self._real_time_factor
            self._status.put(codec.encode(status))

    def event(self, event: Event) -> None:
        """Publish an event."""
        self._event.put(codec.encode(event))

    def command(self, arm: str, payload: bytes) -> None:
        """Publish the command of one arm."""
        self._commands[arm].put(payload)

    def close(self) -> None:
        """Close the room's publishers."""
        for publisher in (self._state, self._event, self._status, *self._commands.values()):
            publisher.close()
