"""What a seat tells its room as events."""

from __future__ import annotations

import asyncio
from typing import Any

from mart.protocol import clock, codec, keys
from mart.protocol.messages import Cue, Event
from mart.runtime.bus.aio import AsyncBus
from mart.teleop_gateway.video.motion_to_photon import MotionToPhoton

LATENCY_EVERY_S = 1.0


class SeatEvents:
    """Open from its making until `close`. `tick`: the newest that the seat has seen."""

    def __init__(self, bus: AsyncBus, room: str, arm: str) -> None:
        self.tick = 0
        self._room, self._arm = room, arm
        self._events = bus.publisher(keys.event(room))

    def close(self) -> None:
        self._events.close()

    def cue(self, cue: Cue) -> None:
        self._tell(cue_given=Event.CueGiven(arm=self._arm, cue=cue))

    async def report(self, latency: MotionToPhoton) -> None:
        """While pages report: once a second, until cancelled."""
        reported = 0
        while True:
            await asyncio.sleep(LATENCY_EVERY_S)
            summary = latency.summary()
            if summary is not None and latency.reports > reported:
                reported = latency.reports
                self._tell(latency=summary.event(self._arm))

    def _tell(self, **what: Any) -> None:
        event = Event(wall_ns=clock.wall_ns(), room=self._room, tick=self.tick, **what)
        self._events.put(codec.encode(event))
