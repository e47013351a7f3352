"""Tell a room, as events, what happens at one of its seats."""

from __future__ import annotations

from typing import Any

from mart.protocol import clock, codec, keys
from mart.protocol.messages import Cue, Event
from mart.runtime.bus.aio import AsyncBus
from mart.teleop_gateway.served_seats import SeatAddress

_MAX_CHARACTERS = 500


class SeatEvents:
    """Publish events of one seat. Open from its making until `close`; `tick` is the newest that the seat has seen."""

    def __init__(self, bus: AsyncBus, seat: SeatAddress) -> None:
        self.tick = 0
        self._seat = seat
        self._events = bus.publisher(keys.event(seat.room))

    def close(self) -> None:
        """Publish nothing any more."""
        self._events.close()

    def cue(self, cue: Cue) -> None:
        """Tell that this seat's holder gave a word to the partners."""
        self._tell(cue_given=Event.CueGiven(arm=self._seat.arm, cue=cue))

    def latency(self, measured: Event.Latency) -> None:
        """Tell what was measured from motion to photon."""
        self._tell(latency=measured)

    def picture_cost(self, picture_s: float) -> None:
        """Tell what a picture of this seat takes, drawn and encoded at full size."""
        self._tell(picture_cost=Event.PictureCost(arm=self._seat.arm, picture_ms=picture_s * 1e3))

    def no_picture(self, reason: str) -> None:
        """Tell that this seat cannot be drawn, and why."""
        self._tell(no_picture=Event.NoPicture(arm=self._seat.arm, reason=reason[:_MAX_CHARACTERS]))

    def _tell(self, **what: Any) -> None:
        event = Event(wall_ns=clock.wall_ns(), room=self._seat.room, tick=self.tick, **what)
        self._events.put(codec.encode(event))
