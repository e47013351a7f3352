"""Watchers without browsers: peers that take what a page takes, and neither decode nor draw it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import struct
import threading
from collections.abc import Callable, Coroutine, Iterator, Sequence
from typing import Any, TypeVar
from unittest import mock

from aiortc import RTCConfiguration, RTCDataChannel, RTCPeerConnection, RTCSessionDescription, rtcrtpreceiver

from mart.platform.collect.web_client import WebClient
from mart.protocol import clock
from mart.protocol.errors import Unavailable
from mart.teleop_gateway.webrtc import status_channel

_PING_EVERY_S = 1.0
_OPEN_TIMEOUT_S = 30.0
_TICK_AT = 8  # in a message with poses: docs/protocol.md, "Body poses"
_OFFER_EVERY_S = 0.25  # a seat takes five a second
T = TypeVar("T")


class Watcher:
    """Hold one page's connection to a seat."""

    def __init__(self) -> None:
        self._poses = 0
        self._connection = RTCPeerConnection(RTCConfiguration([]))
        self._status = self._channel("status")
        self._opened = asyncio.Event()
        self._status.on("open", self._opened.set)
        self._channel("bodies").on("message", self._on_poses)
        self._receiver = self._connection.addTransceiver("video", direction="recvonly").receiver
        self._pinging: asyncio.Task[None] | None = None

    async def open(self, exchange: Callable[[str], str], *, draws: bool) -> None:
        """Connect, and say that the page draws where it does."""
        await self._connection.setLocalDescription(await self._connection.createOffer())
        answer = await asyncio.to_thread(exchange, self._connection.localDescription.sdp)
        await self._connection.setRemoteDescription(RTCSessionDescription(answer, "answer"))
        await asyncio.wait_for(self._opened.wait(), _OPEN_TIMEOUT_S)
        drawing = {"type": "drawing", "on": draws, "p50_ms": 0.0, "p95_ms": 0.0, "per_s": 60.0}
        self._status.send(json.dumps(drawing))
        # Both ends are on this machine: the clocks differ by this, and by nothing else.
        self._status.send(status_channel.clock_offset(clock.wall_ns() - clock.monotonic_ns()))
        self._pinging = asyncio.ensure_future(self._ping())

    async def received(self) -> tuple[int, int]:
        """Return how many packets of video came, and how many messages with poses."""
        stats = await self._receiver.getStats()
        packets = sum(one.packetsReceived for one in stats.values() if one.type == "inbound-rtp")
        return packets, self._poses

    async def close(self) -> None:
        """End the connection."""
        if self._pinging is not None:
            self._pinging.cancel()
        await self._connection.close()

    async def _ping(self) -> None:
        while True:
            self._status.send(status_channel.ping(clock.monotonic_ns() // 1000))
            await asyncio.sleep(_PING_EVERY_S)

    def _on_poses(self, message: bytes) -> None:
        """Tell that the tick is here, as a page does once it has drawn it."""
        self._poses += 1
        (tick,) = struct.unpack_from("<Q", message, _TICK_AT)
        self._status.send(json.dumps({"type": "seen", "tick": tick, "t_us": clock.monotonic_ns() / 1000}))

    def _channel(self, label: str) -> RTCDataChannel:
        return self._connection.createDataChannel(label, ordered=False, maxRetransmits=0)


@contextlib.contextmanager
def watching(clients: Sequence[WebClient], room: str, arm: str, *, draws: bool) -> Iterator[None]:
    """Have each of these watch a seat: by video, or by poses where they draw.

    Raises RuntimeError at the end where one has seen nothing.
    """
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, name="watchers", daemon=True)
    thread.start()

    def run(work: Coroutine[Any, Any, T]) -> T:
        return asyncio.run_coroutine_threadsafe(work, loop).result(2 * _OPEN_TIMEOUT_S)

    async def opened(client: WebClient) -> Watcher:
        watcher = Watcher()
        await watcher.open(lambda sdp: client.offer(room, arm, sdp), draws=draws)
        return watcher

    def close(watcher: Watcher) -> None:
        packets, poses = run(watcher.received())
        run(watcher.close())
        if not (poses if draws else packets):
            raise RuntimeError(
                f"A watcher saw nothing: {packets} packets of video, {poses} messages with poses."
            )

    with mock.patch.object(rtcrtpreceiver, "decoder_worker", _discard), contextlib.ExitStack() as stack:
        stack.callback(loop.close)
        stack.callback(thread.join)
        stack.callback(loop.call_soon_threadsafe, loop.stop)
        for client in clients:
            if draws:
                _have_scene_made(client, room, arm)
            stack.callback(close, run(opened(client)))
            clock.sleep_s(_OFFER_EVERY_S)
        yield


def _have_scene_made(client: WebClient, room: str, arm: str) -> None:
    """As a page does: a seat that has just opened has no model yet."""
    until_s = clock.monotonic_s() + _OPEN_TIMEOUT_S
    while True:
        try:
            client.scene(room, arm)
        except Unavailable:
            if clock.monotonic_s() > until_s:
                raise
            clock.sleep_s(0.2)
        else:
            return


def _discard(loop: asyncio.AbstractEventLoop, encoded: Any, decoded: Any, _error: threading.Event) -> None:
    """Stand in for aiortc's decoder: a browser's would run on another machine."""
    while encoded.get() is not None:
        pass
    asyncio.run_coroutine_threadsafe(decoded.put(None), loop)
