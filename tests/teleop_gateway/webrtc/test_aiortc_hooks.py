"""The private parts of aiortc that the gateway stands on are where it expects them."""

from __future__ import annotations

import asyncio
import itertools
import math
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any

import numpy as np
import pytest
from aiortc import (
    RTCConfiguration,
    RTCPeerConnection,
    RTCRtpReceiver,
    RTCRtpSender,
    RTCSessionDescription,
    rtp,
)
from aiortc.codecs import HEADER_EXTENSIONS

from mart.teleop_gateway.video.encoder import RECORDED, Codec, EncodedPicture, Encoder, to_i420
from mart.teleop_gateway.video.tick_code import HEIGHT_PX, WIDTH_PX
from mart.teleop_gateway.webrtc import aiortc_hooks
from mart.teleop_gateway.webrtc.rate_control import ReceiverReport
from mart.teleop_gateway.webrtc.track import EncodedTrack
from tests.teleop_gateway.browser import Browser


class Sender:
    """Sends one keyframe after the other, and keeps what goes onto the wire."""

    def __init__(self, offered_id: int | None) -> None:
        self.offered_id = offered_id
        self.packets: list[bytes] = []
        self.keyframe_wanted = asyncio.Event()
        self.connection = RTCPeerConnection(RTCConfiguration([]))
        self.track = EncodedTrack(lambda: None)
        self.sender = self.connection.addTrack(self.track)
        aiortc_hooks.show_at_once(self.sender)
        aiortc_hooks.on_keyframe_request(self.sender, self.keyframe_wanted.set)
        self.sent: list[tuple[int, int]] = []
        aiortc_hooks.on_packet_sent(self.sender, lambda *packet: self.sent.append(packet))
        self._encoder = Encoder(RECORDED, 20)

    def picture(self, number: int) -> EncodedPicture:
        """Noise: too large for one packet."""
        noise = np.random.default_rng(number).integers(0, 64, (HEIGHT_PX, WIDTH_PX, 3), np.uint8)
        return self._encoder.encode(to_i420(noise), number * 4500, keyframe=True)

    async def exchange(self, sdp: str) -> str:
        if self.offered_id is None:
            sdp = (
                "\r\n".join(line for line in sdp.splitlines() if aiortc_hooks.PLAYOUT_DELAY_URI not in line)
                + "\r\n"
            )
        else:
            uri = aiortc_hooks.PLAYOUT_DELAY_URI
            sdp = sdp.replace(f"extmap:4 {uri}", f"extmap:{self.offered_id} {uri}")
        await self.connection.setRemoteDescription(RTCSessionDescription(sdp, "offer"))
        await self.connection.setLocalDescription(await self.connection.createAnswer())
        send, packets = self.sender.transport._send_rtp, self.packets

        async def spy(data: bytes) -> None:
            if not rtp.is_rtcp(data):
                packets.append(data)
            await send(data)

        self.sender.transport._send_rtp = spy  # type: ignore[method-assign]
        return self.connection.localDescription.sdp


@asynccontextmanager
async def streaming(offered_id: int | None = 4) -> AsyncIterator[tuple[Sender, Browser]]:
    sender, browser = Sender(offered_id), Browser()
    try:
        await browser.connect(sender.exchange)
        receiving = asyncio.ensure_future(browser.next_frame())
        for number in itertools.count(1):
            sender.track.put(sender.picture(number))
            done, _ = await asyncio.wait((receiving,), timeout=0.05)
            if done:
                break
        yield sender, browser
    finally:
        await browser.close()
        await sender.connection.close()


def on_loop(body: Callable[[], Awaitable[None]]) -> None:
    async def run() -> None:
        await body()

    asyncio.run(run())


def extensions_of(packet: bytes) -> dict[int, bytes]:
    parsed = rtp.RtpPacket.parse(packet, rtp.HeaderExtensionsMap())
    start = 12 + 4 * len(parsed.csrc)
    profile, words = int.from_bytes(packet[start : start + 2]), int.from_bytes(packet[start + 2 : start + 4])
    return dict(rtp.unpack_header_extensions(profile, packet[start + 4 : start + 4 + 4 * words]))


@pytest.mark.parametrize("offered_id", [4, 9], ids=["our own number", "the offerer's number"])
def test_every_packet_says_show_at_once(offered_id: int) -> None:
    async def body() -> None:
        async with streaming(offered_id) as (sender, _):
            assert len(sender.packets) > 10
            for packet in sender.packets:
                assert extensions_of(packet)[offered_id] == b"\0\0\0"

    on_loop(body)


def test_a_peer_that_does_not_know_the_extension_gets_none() -> None:
    async def body() -> None:
        async with streaming(None) as (sender, _):
            for packet in sender.packets:
                assert b"\0\0\0" not in extensions_of(packet).values()

    on_loop(body)


def test_pli_reaches_the_handler() -> None:
    async def body() -> None:
        async with streaming() as (sender, browser):
            assert isinstance(browser.receiver, RTCRtpReceiver)
            assert not sender.keyframe_wanted.is_set()
            await browser.receiver._send_rtcp_pli(sender.sender._ssrc)
            await asyncio.wait_for(sender.keyframe_wanted.wait(), 30)

    on_loop(body)


def test_a_packet_is_known_when_it_is_sent_and_can_be_sent_again() -> None:
    """The copy is a retransmission: of another source, with the number of the first in front of its payload."""

    async def body() -> None:
        async with streaming() as (sender, _):
            assert len(sender.sent) == len(sender.packets)
            number, size = sender.sent[-1]
            first = rtp.RtpPacket.parse(sender.packets[-1], rtp.HeaderExtensionsMap())
            assert (first.sequence_number, len(first.payload)) == (number, size)
            await aiortc_hooks.send_again(sender.sender, number)
            again = rtp.RtpPacket.parse(sender.packets[-1], rtp.HeaderExtensionsMap())
            assert again.ssrc != first.ssrc
            assert again.payload == number.to_bytes(2, "big") + first.payload
            assert len(sender.sent) == len(sender.packets) - 1

    on_loop(body)


def report_of(source: int, last_report: int, since_s: float = 0.0) -> rtp.RtcpRrPacket:
    """7 packets lost of 900."""
    info = rtp.RtcpReceiverInfo(source, 1, 7, 900, 0, last_report, int(since_s * 65_536))
    return rtp.RtcpRrPacket(ssrc=1, reports=[info])


def test_what_the_receiver_reports_reaches_its_handlers() -> None:
    async def body() -> None:
        connection = RTCPeerConnection(RTCConfiguration([]))
        sender: Any = connection.addTrack(EncodedTrack(lambda: None))
        reports: list[ReceiverReport] = []
        estimates_bps: list[int] = []
        aiortc_hooks.on_feedback(sender, reports.append, estimates_bps.append)
        await sender._handle_rtcp_packet(report_of(sender._ssrc + 1, 0))  # of another stream
        await sender._handle_rtcp_packet(report_of(sender._ssrc, 0))
        (report,) = reports
        assert (report.lost, report.expected, math.isnan(report.round_trip_s)) == (7, 900, True)
        sender._RTCRtpSender__lsr, sender._RTCRtpSender__lsr_time = 5, time.time() - 0.3
        await sender._handle_rtcp_packet(report_of(sender._ssrc, 5, since_s=0.1))
        assert reports[-1].round_trip_s == pytest.approx(0.2, abs=0.05)
        sender._RTCRtpSender__lsr_time = time.time() + 60  # the clock is set back
        await sender._handle_rtcp_packet(report_of(sender._ssrc, 5, since_s=0.1))
        assert math.isnan(reports[-1].round_trip_s)
        for source in (sender._ssrc, sender._ssrc + 1):
            fci = rtp.pack_remb_fci(512_000, [source])
            await sender._handle_rtcp_packet(rtp.RtcpPsfbPacket(rtp.RTCP_PSFB_APP, 1, 0, fci))
        await sender._handle_rtcp_packet(rtp.RtcpPsfbPacket(rtp.RTCP_PSFB_APP, 1, 0, b"something else"))
        assert estimates_bps == [512_000]
        await connection.close()

    on_loop(body)


def test_the_negotiated_codec_is_known() -> None:
    async def body() -> None:
        async with streaming() as (sender, _):
            (transceiver,) = sender.connection.getTransceivers()
            assert aiortc_hooks.sent_codec(transceiver) == Codec.H264

    on_loop(body)


def test_offering_the_extension_twice_adds_it_once() -> None:
    for _ in range(3):
        aiortc_hooks.offer_playout_delay()
    uris = [extension.uri for extension in HEADER_EXTENSIONS["video"]]
    assert uris.count(aiortc_hooks.PLAYOUT_DELAY_URI) == 1
    ids = [
        extension.id
        for kind in HEADER_EXTENSIONS.values()
        for extension in kind
        if "mid" not in extension.uri
    ]
    assert len(ids) == len(set(ids))


def test_the_private_names_exist() -> None:
    """What the hooks replace: a rename in aiortc must fail here, not in the field."""
    source = RTCRtpSender.__init__.__code__.co_names
    assert "_RTCRtpSender__rtp_header_extensions_map" in source
    assert {"_RTCRtpSender__rtp_history", "_RTCRtpSender__lsr", "_RTCRtpSender__lsr_time"} <= set(source)
    assert callable(RTCRtpSender._send_keyframe)
    assert {"configure", "set"} <= vars(rtp.HeaderExtensionsMap).keys()
