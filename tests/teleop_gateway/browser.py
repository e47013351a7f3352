"""A browser as the gateway sees it: receives the picture, talks on both channels. aiortc on both sides."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any

import numpy as np
from aiortc import (
    MediaStreamTrack,
    RTCConfiguration,
    RTCDataChannel,
    RTCPeerConnection,
    RTCRtpReceiver,
    RTCSessionDescription,
)
from av import VideoFrame

from mart.protocol import clock
from mart.protocol.tokens import Role
from mart.render import Image
from mart.teleop_gateway.input.phone_frame import Flag, PhoneFrame
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.aiortc_hooks import offer_playout_delay
from mart.teleop_gateway.webrtc.audio_hooks import give_transport

Exchange = Callable[[str], Awaitable[str]]


class Browser:
    """One peer of role `browser`, `viewer` or `phone`."""

    def __init__(
        self, role: Role = Role.BROWSER, codec: str = "H264", *, says: MediaStreamTrack | None = None
    ) -> None:
        """`says`: what it says; without, it has no sound at all, as pages of earlier versions."""
        offer_playout_delay()
        self.connection = RTCPeerConnection(RTCConfiguration([]))
        self.told: list[dict[str, Any]] = []
        self._told_more = asyncio.Event()
        self._opened = asyncio.Event()
        self._sequence = 0
        self.status = self._channel("status")
        self.status.on("message", self._on_status)
        self.status.on("open", self._opened.set)
        self.pose = self._channel("pose") if role is not Role.VIEWER else None
        self.receiver: RTCRtpReceiver | None = None
        if role is not Role.PHONE:
            transceiver = self.connection.addTransceiver("video", direction="recvonly")
            capabilities = RTCRtpReceiver.getCapabilities("video")
            assert capabilities is not None
            transceiver.setCodecPreferences([c for c in capabilities.codecs if c.name in {codec, "rtx"}])
            self.receiver = transceiver.receiver
        self.lanes: list[RTCRtpReceiver] = []
        if says is not None:
            talking = self.connection.addTransceiver(says, direction="sendrecv")
            hearing = self.connection.addTransceiver("audio", direction="recvonly")
            give_transport(self.connection, hearing)
            self.lanes = [talking.receiver, hearing.receiver]

    async def connect(self, exchange: Exchange) -> None:
        """Returns when the channels are open; raises what `exchange` raises."""
        await self.connection.setLocalDescription(await self.connection.createOffer())
        answer = await exchange(self.connection.localDescription.sdp)
        await self.connection.setRemoteDescription(RTCSessionDescription(answer, "answer"))
        await asyncio.wait_for(self._opened.wait(), 30)

    async def next_frame(self) -> VideoFrame:
        assert self.receiver is not None
        frame = await asyncio.wait_for(self.receiver.track.recv(), 30)
        assert isinstance(frame, VideoFrame)
        return frame

    async def next_tick(self) -> int | None:
        """Read out of the next picture."""
        return tick_code.read(luma(await self.next_frame()))

    def send_frame(self, frame: PhoneFrame | bytes) -> None:
        if self.pose is not None and self.pose.readyState == "open":
            self.pose.send(frame if isinstance(frame, bytes) else frame.encode())

    def hand(
        self, epoch: int, position: tuple[float, float, float] = (0.0, 0.0, 0.0), **given: Any
    ) -> PhoneFrame:
        """The next frame of a hand that is level and aligned with the screen."""
        self._sequence += 1
        flags = Flag.TRACKING | Flag.SCREEN_ALIGNED | (Flag.CLUTCH if given.pop("clutch", False) else Flag(0))
        sent_us = clock.monotonic_ns() // 1000
        values = {
            "sequence": self._sequence,
            "seen_tick": 0,
            "gripper": 0.0,
            "quaternion_wxyz": (1.0, 0.0, 0.0, 0.0),
            **given,
        }
        return PhoneFrame(seat_epoch=epoch, sent_us=sent_us, position=position, flags=flags, **values)

    async def drive(self, epoch: int, duration_s: float = 1e9, **given: Any) -> None:
        """Sends frames at 60 Hz."""
        end_s = clock.monotonic_s() + duration_s
        while clock.monotonic_s() < end_s:
            self.send_frame(self.hand(epoch, **given))
            await asyncio.sleep(1 / 60)

    async def wait_told(
        self, holds: Callable[[dict[str, Any]], bool], timeout_s: float = 30.0, *, since: int | None = None
    ) -> dict[str, Any]:
        """The next status message for which `holds`; since: the first after so many."""
        seen = len(self.told) if since is None else since
        async with asyncio.timeout(timeout_s):
            while True:
                for message in self.told[seen:]:
                    if holds(message):
                        return message
                seen = len(self.told)
                self._told_more.clear()
                await self._told_more.wait()

    async def synchronise(self) -> float:
        """Believes the quickest of several pings and tells the offset; returns by how much it may be wrong, ms."""
        quickest_us, offset_ns = await self._ping()
        for _ in range(7):
            quickest_us, offset_ns = min((quickest_us, offset_ns), await self._ping())
        self.status.send(status_channel.clock_offset(offset_ns))
        return quickest_us / 2 / 1000

    async def _ping(self) -> tuple[int, int]:
        """The round trip, microseconds, and the offset that it says, nanoseconds."""
        sent_us = clock.monotonic_ns() // 1000
        self.status.send(status_channel.ping(sent_us))
        pong = await self.wait_told(lambda m: m["type"] == "pong")
        round_trip_us = clock.monotonic_ns() // 1000 - sent_us
        return round_trip_us, int(pong["gateway_ns"] - (sent_us + round_trip_us / 2) * 1000)

    async def close(self) -> None:
        await self.connection.close()

    def _channel(self, label: str) -> RTCDataChannel:
        return self.connection.createDataChannel(label, ordered=False, maxRetransmits=0)

    def _on_status(self, text: str) -> None:
        self.told.append(json.loads(text))
        self._told_more.set()


@contextlib.asynccontextmanager
async def connected(
    exchange: Exchange,
    role: Role = Role.BROWSER,
    codec: str = "H264",
    *,
    says: MediaStreamTrack | None = None,
) -> AsyncIterator[Browser]:
    browser = Browser(role, codec, says=says)
    try:
        await browser.connect(exchange)
        yield browser
    finally:
        await browser.close()


@contextlib.asynccontextmanager
async def in_background(work: Awaitable[None]) -> AsyncIterator[None]:
    task = asyncio.ensure_future(work)
    try:
        yield
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task


def luma(frame: VideoFrame) -> Image:
    """Shape (496, 640)."""
    return np.asarray(frame.to_ndarray(format="gray"), np.uint8)
