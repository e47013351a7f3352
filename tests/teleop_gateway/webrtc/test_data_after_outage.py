"""What a gateway says all the time comes at its rate again when an outage of a long way ends."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable

import pytest
from aiortc import RTCConfiguration, RTCPeerConnection, RTCSctpTransport

from mart.teleop_gateway.webrtc.aiortc_hooks import keep_window

ONE_WAY_S, EVERY_S = 0.15, 0.05
BEFORE_S, OUTAGE_S, AFTER_S = 0.5, 1.6, 1.2
STATUS = "x" * 900
Send = Callable[[bytes], Awaitable[None]]


class LongWay:
    """Delays what both ends of a connection send; loses it while it is dark."""

    def __init__(self) -> None:
        self.dark = False

    def lead(self, sctp: RTCSctpTransport) -> None:
        send: Send = sctp.transport._send_data
        loop = asyncio.get_running_loop()

        async def later(data: bytes) -> None:
            if not self.dark:
                loop.call_later(ONE_WAY_S, lambda: asyncio.ensure_future(send(data)))

        sctp.transport._send_data = later  # type: ignore[method-assign]


async def connected(near: RTCPeerConnection, far: RTCPeerConnection, sent_at_s: list[float]) -> LongWay:
    channel = near.createDataChannel("status", ordered=False, maxRetransmits=0)
    opened = asyncio.Event()
    channel.on("open", opened.set)
    far.on(
        "datachannel",
        lambda heard: heard.on("message", lambda text: sent_at_s.append(float(text.split()[0]))),
    )
    await near.setLocalDescription(await near.createOffer())
    await far.setRemoteDescription(near.localDescription)
    await far.setLocalDescription(await far.createAnswer())
    await near.setRemoteDescription(far.localDescription)
    await asyncio.wait_for(opened.wait(), 30)
    way = LongWay()
    for end in (near, far):
        assert end.sctp is not None
        way.lead(end.sctp)
    return way


@pytest.mark.slow
def test_after_an_outage_every_status_comes_at_once() -> None:
    async def body() -> None:
        near, far = (RTCPeerConnection(RTCConfiguration([])) for _ in range(2))
        arrived_s: list[float] = []
        try:
            way = await connected(near, far, arrived_s)
            assert near.sctp is not None
            keep_window(near.sctp)
            (channel,) = near.sctp._data_channels.values()
            begun_s, sent_s = time.monotonic(), list[float]()
            while (now_s := time.monotonic() - begun_s) < BEFORE_S + OUTAGE_S + AFTER_S:
                way.dark = BEFORE_S < now_s < BEFORE_S + OUTAGE_S
                if now_s > BEFORE_S + OUTAGE_S:
                    sent_s.append(now_s)
                channel.send(f"{now_s} {STATUS}")
                await asyncio.sleep(EVERY_S)
            await asyncio.sleep(2 * ONE_WAY_S)
            heard = [one_s for one_s in sent_s if one_s in arrived_s]
            assert len(heard) > 0.8 * len(sent_s), (len(heard), len(sent_s))
        finally:
            await near.close()
            await far.close()

    asyncio.run(body())
