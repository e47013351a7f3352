"""Say again what a room says: its status, and the newest state while no tick fires."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol.messages import RoomStatus, State
from mart.sim.room.room_publisher import REPEAT_S, STATUS_S, RoomPublisher


class Repeats:
    """Publish states and statuses, and remember when each is due again (monotonic seconds)."""

    def __init__(self, publisher: RoomPublisher, now_s: float) -> None:
        self._publisher = publisher
        self._status_due_s = self._state_due_s = now_s

    @property
    def next_s(self) -> float:
        """Return when something is due."""
        return min(self._status_due_s, self._state_due_s)

    def state(self, state: State, now_s: float) -> None:
        """Publish a state."""
        self._publisher.state(state)
        self._state_due_s = now_s + REPEAT_S

    def status_soon(self) -> None:
        """Let the status be said at the next turn, because it has changed."""
        self._status_due_s = 0.0

    def repeat(self, status: Callable[[float], RoomStatus], now_s: float) -> None:
        """Publish what is due; status: as it is at a time."""
        if now_s >= self._state_due_s:
            self._publisher.repeat_state()
            self._state_due_s = now_s + REPEAT_S
        if now_s >= self._status_due_s:
            self._publisher.status(status(now_s))
            self._status_due_s = now_s + STATUS_S
