"""Send one peer what is said on one lane: encoded packets in, RTP out."""

from __future__ import annotations

import asyncio
import fractions
from collections import deque
from typing import Any

import av
from aiortc import MediaStreamTrack
from aiortc.mediastreams import MediaStreamError

from mart.teleop_gateway.voice.lanes import SAMPLES_PER_S, LanePacket

_QUEUE = 10  # 0.2 s


class VoiceTrack(MediaStreamTrack):
    """Pass packets on without touching them, and rest while none come. On overflow the oldest are left out."""

    kind = "audio"

    def __init__(self) -> None:
        super().__init__()
        self._queue: deque[LanePacket] = deque(maxlen=_QUEUE)
        self._arrived = asyncio.Event()

    def put(self, packet: LanePacket) -> None:
        """Queue a packet, on the event loop."""
        self._queue.append(packet)
        self._arrived.set()

    async def recv(self) -> av.Packet[Any]:
        """Return the next packet; raises MediaStreamError once the track has ended."""
        while not self._queue:
            if self.readyState != "live":
                raise MediaStreamError
            self._arrived.clear()
            await self._arrived.wait()
        spoken = self._queue.popleft()
        packet = av.Packet(spoken.opus)
        packet.pts = spoken.time
        packet.time_base = fractions.Fraction(1, SAMPLES_PER_S)
        return packet

    def stop(self) -> None:
        """End the track, and whoever waits for a packet of it."""
        super().stop()
        self._arrived.set()
