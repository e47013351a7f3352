"""Show an automatic rate what a room says, on its way to the bus."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol.messages import Event, RoomStatus, State
from mart.sim.room.automatic_rate import AutomaticRate
from mart.sim.room.room_publisher import RoomPublisher


class RateWatch:
    """Publish what a room says, and let `rate` see it first."""

    def __init__(self, publisher: RoomPublisher, rate: AutomaticRate, now_s: Callable[[], float]) -> None:
        self._publisher, self._rate, self._now_s = publisher, rate, now_s

    def state(self, state: State) -> None:
        """Publish a state."""
        self._rate.see_state(state, self._now_s())
        self._publisher.state(state)

    def repeat_state(self) -> None:
        """Publish the newest state once more."""
        self._publisher.repeat_state()

    def status(self, status: RoomStatus) -> None:
        """Publish how the room stands."""
        self._rate.see_status(status, self._now_s())
        self._publisher.status(status)

    def event(self, event: Event) -> None:
        """Publish what has just happened."""
        if event.HasField("seat_changed"):
            self._rate.see_seat(event.seat_changed)
        self._publisher.event(event)
