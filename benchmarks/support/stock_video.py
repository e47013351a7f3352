"""Show a real Chromium pictures as a plain program on aiortc does, and measure when it shows them.

Nothing of the gateway is in it: aiortc's own track and encoder, and a page that leaves its receiver as it is.
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from unittest import mock

import av
from aiortc import RTCPeerConnection, RTCSessionDescription, VideoStreamTrack, rtcrtpsender
from aiortc.mediastreams import VIDEO_CLOCK_RATE, VIDEO_TIME_BASE
from support.watching_page import SETTLE_S, Displayed, accept, offer_of, shown, watching_page

from mart.protocol import clock
from mart.render import Image


class _Pictures(VideoStreamTrack):
    """Show these pictures again and again, each when it is due; notes when, by its time stamp."""

    def __init__(self, pictures: Sequence[Image], frames_per_s: float) -> None:
        super().__init__()
        self._pictures, self._frames_per_s = pictures, frames_per_s
        self._begun_s, self._count = clock.monotonic_s(), 0
        self.drawn_ms: dict[int, float] = {}

    async def recv(self) -> av.VideoFrame:
        due_s = self._begun_s + self._count / self._frames_per_s
        await asyncio.sleep(max(0.0, due_s - clock.monotonic_s()))
        frame = av.VideoFrame.from_ndarray(self._pictures[self._count % len(self._pictures)], format="rgb24")
        frame.pts, frame.time_base = round((due_s - self._begun_s) * VIDEO_CLOCK_RATE), VIDEO_TIME_BASE
        self.drawn_ms[frame.pts] = clock.wall_ns() * 1e-6
        self._count += 1
        return frame


def show_by_stock_aiortc(pictures: Sequence[Image], frames_per_s: float, seconds: float) -> Displayed:
    """Show a browser these pictures again and again for so long, by aiortc alone."""
    return asyncio.run(_show(pictures, frames_per_s, seconds))


async def _show(pictures: Sequence[Image], frames_per_s: float, seconds: float) -> Displayed:
    async with watching_page() as page:
        peer = RTCPeerConnection()
        track = _Pictures(pictures, frames_per_s)
        offer = await offer_of(page, shows_at_once=False)
        await peer.setRemoteDescription(RTCSessionDescription(sdp=offer, type="offer"))
        peer.addTrack(track)
        # Then a picture's time stamp is the same at both ends.
        with mock.patch.object(rtcrtpsender, "random32", return_value=0):
            await peer.setLocalDescription(await peer.createAnswer())
            await accept(page, peer.localDescription.sdp)
            await asyncio.sleep(SETTLE_S + seconds)
        at_ms, delay_ms, _ = await shown(page, track.drawn_ms)
        await peer.close()
    return Displayed(at_ms, delay_ms)
