"""Connections that only try the way to a gateway: they send back what they get, and cost little."""

from __future__ import annotations

import asyncio

import pytest
from aiortc import RTCConfiguration, RTCDataChannel, RTCPeerConnection, RTCSessionDescription

from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.messages import Offer
from mart.runtime.ice_servers import IceSettings
from mart.teleop_gateway.webrtc import connection_check
from mart.teleop_gateway.webrtc.connection_check import MAX_AT_ONCE, MAX_BYTES, ConnectionChecks


class Visitor:
    """The other end. `heard`: what came back."""

    def __init__(self, label: str = connection_check.CHANNEL) -> None:
        self.connection = RTCPeerConnection(RTCConfiguration([]))
        self.channel: RTCDataChannel = self.connection.createDataChannel(
            label, ordered=False, maxRetransmits=0
        )
        self.opened, self.closed = asyncio.Event(), asyncio.Event()
        self.heard: asyncio.Queue[str] = asyncio.Queue()
        self.channel.on("open", self.opened.set)
        self.channel.on("message", self.heard.put_nowait)
        self.connection.on("connectionstatechange", self._on_state)

    def _on_state(self) -> None:
        if self.connection.connectionState == "closed":
            self.closed.set()

    async def offer(self) -> str:
        await self.connection.setLocalDescription(await self.connection.createOffer())
        return self.connection.localDescription.sdp

    async def connect(self, checks: ConnectionChecks) -> None:
        answer = await checks.answer(Offer(sdp=await self.offer()))
        await self.connection.setRemoteDescription(RTCSessionDescription(answer.sdp, "answer"))
        await asyncio.wait_for(self.opened.wait(), 10)


def test_what_is_sent_comes_back_and_nothing_that_is_too_long() -> None:
    async def visit() -> list[str]:
        checks, visitor = ConnectionChecks(IceSettings()), Visitor()
        try:
            await visitor.connect(checks)
            visitor.channel.send("x" * (MAX_BYTES + 1))
            visitor.channel.send("1")
            return [await asyncio.wait_for(visitor.heard.get(), 10)]
        finally:
            await visitor.connection.close()
            await checks.close()

    assert asyncio.run(visit()) == ["1"]


def test_a_connection_ends_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection_check, "LIFETIME_S", 0.5)

    async def visit() -> None:
        checks, visitor = ConnectionChecks(IceSettings()), Visitor()
        await visitor.connect(checks)
        await asyncio.wait_for(visitor.closed.wait(), 10)
        await checks.close()
        await visitor.connection.close()

    asyncio.run(visit())


def test_a_few_are_tried_at_a_time_and_a_bad_offer_takes_no_place() -> None:
    async def visit() -> None:
        checks, visitor = ConnectionChecks(IceSettings()), Visitor()
        try:
            for garbage in ("", "v=0", "m=video 9 UDP/TLS/RTP/SAVPF 96\r\n") * MAX_AT_ONCE:
                with pytest.raises(InvalidInput):
                    await checks.answer(Offer(sdp=garbage))
                await asyncio.sleep(0)
            sdp = await visitor.offer()
            for _ in range(MAX_AT_ONCE):
                await checks.answer(Offer(sdp=sdp))
            with pytest.raises(Unavailable):
                await checks.answer(Offer(sdp=sdp))
        finally:
            await checks.close()
            await visitor.connection.close()

    asyncio.run(visit())
