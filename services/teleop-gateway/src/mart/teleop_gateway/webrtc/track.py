"""Feed one peer: encoded pictures in, RTP out, with a queue that never grows old."""

from __future__ import annotations

import asyncio
import fractions
from collections import deque
from collections.abc import Callable
from typing import Any

import av
from aiortc import MediaStreamTrack
from aiortc.mediastreams import MediaStreamError

from mart.teleop_gateway.video.encoder import CLOCK_HZ, EncodedPicture

_QUEUE = 3


class EncodedTrack(MediaStreamTrack):
    """Pass encoded pictures on without touching them.

    A picture builds on the one before, so none may be left out of the middle: on overflow everything waiting is
    dropped, and nothing is sent until the keyframe that is asked for then.
    """

    kind = "video"

    def __init__(self, request_keyframe: Callable[[], None]) -> None:
        super().__init__()
        self._request_keyframe = request_keyframe
        self._queue: deque[EncodedPicture] = deque()
        self._arrived = asyncio.Event()
        self._started = False
        self._needs_keyframe = True

    def put(self, encoded: EncodedPicture) -> None:
        """Queue a picture, on the event loop. Ignored until the connection asks for its first one."""
        if not self._started or (self._needs_keyframe and not encoded.keyframe):
            return
        if len(self._queue) >= _QUEUE and not encoded.keyframe:
            self._queue.clear()
            self._needs_keyframe = True
            self._request_keyframe()
            return
        if encoded.keyframe:
            self._queue.clear()  # it needs nothing that came before
            self._needs_keyframe = False
        self._queue.append(encoded)
        self._arrived.set()

    def restart(self) -> None:
        """Begin anew, after a while in which nothing was put: the next picture that is sent is a keyframe."""
        self._queue.clear()
        self._needs_keyframe = True
        self._request_keyframe()

    async def recv(self) -> av.Packet[Any]:
        """Return the next picture as a packet; raises MediaStreamError once the track has ended."""
        if not self._started:
            self._started = True
            self._request_keyframe()
        while not self._queue:
            if self.readyState != "live":
                raise MediaStreamError
            self._arrived.clear()
            await self._arrived.wait()
        encoded = self._queue.popleft()
        packet = av.Packet(encoded.data)
        packet.pts = encoded.pts
        packet.time_base = fractions.Fraction(1, CLOCK_HZ)
        return packet

    def stop(self) -> None:
        """End the track, and whoever waits for a picture of it."""
        super().stop()
        self._arrived.set()
