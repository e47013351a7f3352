"""Answer offers of connections that only try the way to this gateway: a channel whose messages come back.

Such a connection sees no seat and no picture. What one may cost is bounded: a few at a time, each for some seconds, and
each with so many short messages.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Sequence

from aiortc import RTCConfiguration, RTCDataChannel, RTCPeerConnection, RTCSessionDescription

from mart.protocol import clock
from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.messages import Answer, Offer
from mart.runtime.ice_servers import IceServer, IceSettings
from mart.runtime.rate_limit import RateLimit
from mart.teleop_gateway.webrtc.aiortc_hooks import close_connection, on_unreadable
from mart.teleop_gateway.webrtc.ice_candidates import bounded_candidates
from mart.teleop_gateway.webrtc.ice_watch import IceWatch
from mart.teleop_gateway.webrtc.named_candidates import add_named
from mart.teleop_gateway.webrtc.peer import as_aiortc

CHANNEL = "echo"
LIFETIME_S = 15.0
MAX_AT_ONCE = 8
MAX_BYTES = 64
MAX_PER_S = 100


class ConnectionChecks:
    """The connections that are being tried now. For the event loop on which it is made."""

    def __init__(self, settings: IceSettings) -> None:
        """Use the STUN and TURN servers of `settings` that answer."""
        logging.getLogger("aioice").setLevel(logging.WARNING)  # it tells about every candidate pair
        self._ice = IceWatch(settings)
        self._open: dict[asyncio.Task[None], _TriedConnection] = {}

    async def answer(self, offer: Offer) -> Answer:
        """Answer an offer; its connection ends by itself.

        Raises InvalidInput where the offer cannot be used, Unavailable where too many are being tried.
        """
        if len(self._open) >= MAX_AT_ONCE:
            raise Unavailable(
                f"{MAX_AT_ONCE} connections are being tried already; check again in {LIFETIME_S:g} s."
            )
        connection = _TriedConnection()
        task = asyncio.get_running_loop().create_task(connection.live())
        self._open[task] = connection  # its place is taken before anything is awaited
        task.add_done_callback(self._open.pop)
        try:
            await self._ice.check()
            return Answer(sdp=await connection.answer(offer.sdp, self._ice.usable()))
        except BaseException:
            connection.ended.set()
            raise

    async def close(self) -> None:
        """Return when all connections have ended."""
        for connection in self._open.values():
            connection.ended.set()
        await asyncio.gather(*self._open, return_exceptions=True)


class _TriedConnection:
    def __init__(self) -> None:
        self.ended = asyncio.Event()
        self._connection: RTCPeerConnection | None = None
        self._looking_up: asyncio.Task[None] | None = None
        self._rate = RateLimit(MAX_PER_S)

    async def live(self) -> None:
        """Return when the connection has ended, by its time at the latest."""
        with contextlib.suppress(TimeoutError):  # its time is over
            async with asyncio.timeout(LIFETIME_S):
                await self.ended.wait()
        if self._looking_up is not None:
            self._looking_up.cancel()
        if self._connection is not None:
            await close_connection(self._connection)

    async def answer(self, sdp: str, ice_servers: Sequence[IceServer]) -> str:
        connection = RTCPeerConnection(RTCConfiguration([*map(as_aiortc, ice_servers)]))
        self._connection = connection
        connection.on("datachannel", self._on_channel)
        connection.on("connectionstatechange", self._on_state)
        try:
            bounded, named = bounded_candidates(sdp)
            await self._negotiate(connection, bounded)
        except Exception as error:  # a malformed SDP raises whatever the parser trips over
            raise InvalidInput(f"An offer was given that cannot be answered: {error}") from error
        self._looking_up = asyncio.create_task(add_named(connection, named)) if named else None
        return connection.localDescription.sdp

    async def _negotiate(self, connection: RTCPeerConnection, sdp: str) -> None:
        await connection.setRemoteDescription(RTCSessionDescription(sdp, "offer"))
        if connection.sctp is None or connection.getTransceivers():
            raise InvalidInput("a connection that is tried has a data channel and nothing else")
        on_unreadable(connection.sctp, lambda _error: self.ended.set())
        await connection.setLocalDescription(await connection.createAnswer())

    def _on_state(self) -> None:
        if self._connection is not None and self._connection.connectionState in ("closed", "failed"):
            self.ended.set()

    def _on_channel(self, channel: RTCDataChannel) -> None:
        if channel.label != CHANNEL:
            self.ended.set()
            return

        def send_back(message: bytes | str) -> None:
            if len(message) <= MAX_BYTES and self._rate.allows(clock.monotonic_s()):
                channel.send(message)

        channel.on("message", send_back)
