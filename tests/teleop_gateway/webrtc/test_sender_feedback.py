"""What one receiver reports changes what its sender sends: how much, and whether everything goes twice."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Awaitable, Callable
from typing import Any

from aiortc import RTCConfiguration, RTCPeerConnection, rtp

from mart.teleop_gateway.webrtc import sender_feedback
from mart.teleop_gateway.webrtc.rate_control import FLOOR_BPS
from mart.teleop_gateway.webrtc.sender_feedback import SenderFeedback
from mart.teleop_gateway.webrtc.track import EncodedTrack


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
