"""Define what a room needs of whoever publishes what it says."""

from __future__ import annotations

from typing import Protocol

from mart.protocol.messages import Event, RoomStatus, State

STATUS_S = 0.1  # whoever hears nothing for a few of these says that the room does not answer
REPEAT_S = 0.2  # the newest state while no tick fires, for those who came late


class RoomPublisher(Protocol):
    """Publish what a room says. None of these may block."""

    def state(self, state: State) -> None:
        """Publish the state after a tick or a reset."""

    def repeat_state(self) -> None:
        """Publish the newest state once more, the very same bytes."""

    def status(self, status: RoomStatus) -> None:
        """Publish how the room stands."""

    def event(self, event: Event) -> None:
        """Publish what has just happened."""
