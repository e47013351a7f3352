"""Hold a phone's connection to its seat's gateway over WebRTC, as the phone's page does."""

from __future__ import annotations

import asyncio
import json
import logging
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any

from aiortc import RTCConfiguration, RTCDataChannel, RTCPeerConnection, RTCSessionDescription

from mart.protocol import clock
from mart.protocol.errors import MartError, Unavailable
from mart.teleop_gateway.input.phone_frame import PhoneFrame
from mart.teleop_gateway.webrtc import status_channel

_log = logging.getLogger(__name__)

FRAMES_PER_S = 60.0
_PING_EVERY_S = 1.0
_PINGS = 8
_CONNECT_TIMEOUT_S = 10.0
_SILENT_S = 2.0
_RETRY_S = 0.5

Exchange = Callable[[str], Awaitable[str]]  # an offer's SDP → the answer's; raises MartError
Carry = Callable[
    [Callable[[], None]], None
]  # calls what it is given when a message arrives; never, where it is lost


def at_once(deliver: Callable[[], None]) -> None:
    """Carry a message as the network at hand does."""
    deliver()


class PhoneConnection:
    """Send a frame FRAMES_PER_S times a second, as long as the gateway is heard.

    `exchange` is how a page signals; `next_frame`: monotonic seconds and the seconds since the last → the frame.
    """

    def __init__(
        self,
        name: str,
        exchange: Exchange,
        next_frame: Callable[[float, float], PhoneFrame],
        *,
        on_told: Callable[[dict[str, Any]], None],
        uplink: Carry = at_once,
        downlink: Carry = at_once,
    ) -> None:
        """Prepare a connection; `name`: whose, in logs; `on_told` hears every status message, as JSON."""
        self._name, self._exchange, self._next_frame, self._on_told = name, exchange, next_frame, on_told
        self._uplink, self._downlink = uplink, downlink
        self._pings: deque[tuple[float, int]] = deque(maxlen=_PINGS)  # round trip in us, offset in ns
        self._heard_s = 0.0
        self._replaced = False

    async def run(self) -> None:
        """Connect, and connect anew when that breaks, until cancelled or replaced by another phone."""
        while not self._replaced:
            try:
                await self._drive_once()
            except MartError as error:
                _log.warning("The phone of %s is not connected: %s", self._name, error)
            await asyncio.sleep(_RETRY_S)
        _log.info("Another phone drives %s now", self._name)

    async def _drive_once(self) -> None:
        """Hold one connection, until it breaks."""
        connection = RTCPeerConnection(RTCConfiguration([]))
        try:
            pose = _lossy(connection, "pose")
            status = _lossy(connection, "status")
            status.on("message", lambda text: self._downlink(lambda: self._on_status(text, status)))
            await self._connect(connection, pose)
            self._heard_s = clock.monotonic_s()
            _log.info("The phone of %s is connected", self._name)
            pinging = asyncio.ensure_future(self._ping(status))
            try:
                await self._send_frames(pose)
            finally:
                pinging.cancel()
        finally:
            await connection.close()

    async def _connect(self, connection: RTCPeerConnection, pose: RTCDataChannel) -> None:
        opened = asyncio.Event()
        pose.on("open", opened.set)
        await connection.setLocalDescription(await connection.createOffer())
        answer = await self._exchange(connection.localDescription.sdp)
        await connection.setRemoteDescription(RTCSessionDescription(answer, "answer"))
        try:
            async with asyncio.timeout(_CONNECT_TIMEOUT_S):
                await opened.wait()
        except TimeoutError as error:
            raise Unavailable(f"No connection came up within {_CONNECT_TIMEOUT_S:g} s.") from error

    async def _send_frames(self, pose: RTCDataChannel) -> None:
        before_s = clock.monotonic_s()
        due_s = before_s
        while pose.readyState == "open":
            now_s = clock.monotonic_s()
            if now_s - self._heard_s > _SILENT_S:
                raise Unavailable(f"The gateway has said nothing for {_SILENT_S:g} s.")
            frame = self._next_frame(now_s, now_s - before_s).encode()
            self._uplink(lambda frame=frame: _send(pose, frame))  # type: ignore[misc]
            before_s = now_s
            due_s = max(due_s + 1.0 / FRAMES_PER_S, now_s)
            await asyncio.sleep(due_s - now_s)

    async def _ping(self, status: RTCDataChannel) -> None:
        while True:
            text = status_channel.ping(now_us())
            self._uplink(lambda text=text: _send(status, text))  # type: ignore[misc]
            await asyncio.sleep(_PING_EVERY_S)

    def _on_status(self, text: str, status: RTCDataChannel) -> None:
        self._heard_s = clock.monotonic_s()
        message = json.loads(text)
        if message["type"] == "tick":
            self._on_told(message)
        elif message["type"] == "pong":
            self._on_pong(message, status)
        elif message["type"] == "replaced":
            self._replaced = True

    def _on_pong(self, message: dict[str, Any], status: RTCDataChannel) -> None:
        """Tell the clock offset of the fastest of the last pings: half of its way is the least wrong."""
        arrived_us = now_us()
        middle_us = (message["t_us"] + arrived_us) / 2
        self._pings.append((arrived_us - message["t_us"], int(message["gateway_ns"] - middle_us * 1000)))
        offset_ns = min(self._pings)[1]
        self._uplink(lambda: _send(status, status_channel.clock_offset(offset_ns)))


def now_us() -> int:
    """Return this phone's own clock, microseconds."""
    return clock.monotonic_ns() // 1000


def _lossy(connection: RTCPeerConnection, label: str) -> RTCDataChannel:
    return connection.createDataChannel(label, ordered=False, maxRetransmits=0)


def _send(channel: RTCDataChannel, message: bytes | str) -> None:
    if channel.readyState == "open":
        channel.send(message)
