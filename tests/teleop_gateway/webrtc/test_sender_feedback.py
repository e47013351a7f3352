"""What one receiver reports changes what its sender sends: how much, and whether everything goes twice."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Awaitable, Callable
from typing import Any

import pytest
from aiortc import RTCConfiguration, RTCPeerConnection, rtp

from mart.teleop_gateway.webrtc import sender_feedback
from mart.teleop_gateway.webrtc.rate_control import FLOOR_BPS
from mart.teleop_gateway.webrtc.sender_feedback import SenderFeedback
from mart.teleop_gateway.webrtc.track import EncodedTrack
from tools.netrelay.impairment import PROFILES
from tools.netrelay.packet_scheduler import PacketLoss, PacketScheduler


class Receiver:
    """Reports to a sender without a connection, which notes what it was to send again."""

    def __init__(self, sender: Any) -> None:
        self._sender = sender
        self._expected = self._lost = 0
        self.again: list[int] = []
        self.resent = asyncio.Event()
        self.limits = 0
        self.feedback = SenderFeedback(sender, self._on_limit)
        sender._retransmit = self._on_retransmit

    async def report(self, lost: int, of: int, round_trip_s: float) -> None:
        self._expected, self._lost = self._expected + of, self._lost + lost
        self._sender._RTCRtpSender__lsr = 1
        self._sender._RTCRtpSender__lsr_time = time.time() - round_trip_s - 1 / 65_536
        info = rtp.RtcpReceiverInfo(self._sender._ssrc, 0, self._lost, self._expected, 0, 1, 1)
        await self._sender._handle_rtcp_packet(rtp.RtcpRrPacket(ssrc=1, reports=[info]))

    def send(self, number: int) -> None:
        packet = rtp.RtpPacket(sequence_number=number, payload=bytes(1000))
        self._sender._RTCRtpSender__rtp_history[number % 128] = packet

    async def _on_retransmit(self, number: int) -> None:
        self.again.append(number)
        self.resent.set()

    def _on_limit(self) -> None:
        self.limits += 1


def with_receiver(body: Callable[[Receiver], Awaitable[None]]) -> None:
    async def run() -> None:
        connection = RTCPeerConnection(RTCConfiguration([]))
        receiver = Receiver(connection.addTrack(EncodedTrack(lambda: None)))
        await body(receiver)
        receiver.feedback.close()
        await connection.close()

    asyncio.run(run())


def test_packets_go_twice_once_one_was_lost_far_away() -> None:
    async def body(receiver: Receiver) -> None:
        await receiver.report(0, 50, 0.3)
        receiver.send(1)
        await receiver.report(1, 50, 0.3)
        receiver.send(2)
        await asyncio.wait_for(receiver.resent.wait(), 30)
        assert receiver.again == [2]
        receiver.send(3)
        receiver.feedback.close()
        await asyncio.sleep(2 * sender_feedback._COPY_AFTER_S)
        assert receiver.again == [2]

    with_receiver(body)


def test_packets_go_once_where_asking_again_is_quick() -> None:
    async def body(receiver: Receiver) -> None:
        for number in range(3):
            await receiver.report(1, 50, 0.01)
            receiver.send(number)
        await asyncio.sleep(2 * sender_feedback._COPY_AFTER_S)
        assert receiver.again == []

    with_receiver(body)


def test_a_link_that_loses_much_is_limited_and_whoever_listens_is_told() -> None:
    async def body(receiver: Receiver) -> None:
        assert receiver.feedback.limit_bps == math.inf
        for number in range(10):
            receiver.send(number)
            await receiver.report(20, 50, 0.01)
        assert receiver.limits == 10
        assert FLOOR_BPS <= receiver.feedback.limit_bps < math.inf

    with_receiver(body)


@pytest.mark.parametrize("frames_per_s", [20, 60])
def test_a_copy_comes_through_where_a_burst_took_the_packet(frames_per_s: int) -> None:
    """Packets are lost two at a time, one of a hundred: without copies it is 14 and 37 pictures in 20 s."""
    incomplete = [_incomplete(frames_per_s, seconds=20, seed=seed) for seed in range(6)]
    assert sum(incomplete) / len(incomplete) <= 0.5


def _incomplete(frames_per_s: int, seconds: int, seed: int) -> int:
    """Return how many pictures lack a packet, both times that it was sent, over a link between continents."""
    link = PacketScheduler(PROFILES["intercontinental"].down, seed, began_ns=0)
    packets = [(number, part) for number in range(seconds * frames_per_s) for part in range(4)]
    sent = [
        (number / frames_per_s + part * 2e-5 + copy * sender_feedback._COPY_AFTER_S, number, part)
        for number, part in packets
        for copy in range(2)
    ]
    arrived = {
        (number, part)
        for sent_s, number, part in sorted(sent)
        if not isinstance(link.schedule(round(sent_s * 1e9), 1200), PacketLoss)
    }
    return len({number for number, part in packets if (number, part) not in arrived})
