"""Show a real Chromium, behind tools/netrelay or not, a seat's pictures, and measure when it shows them.

The gateway's own peers, encoders and rate control send; a scene in which both arms move is drawn beforehand, so that
this machine's cores are free for both ends of the link.
"""

from __future__ import annotations

import asyncio
import contextlib
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from aiortc import rtcrtpsender
from support.watching_page import SETTLE_S, Displayed, accept, offer_of, shown, watching_page

from mart.platform.collect.browser import chromium_path
from mart.protocol import clock
from mart.protocol.errors import Unavailable
from mart.protocol.tokens import Role
from mart.render import Image
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.video.encoder import Stream
from mart.teleop_gateway.video.quality import FAST
from mart.teleop_gateway.video.stream_encoders import StreamEncoders
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peers import Peers
from mart.teleop_gateway.webrtc.rate_control import RateControl

_NAMESPACE = "bench-video"
_NUMBER = 93


@dataclass
class _Orders:
    """Keep what peers want, as the listener of peers."""

    limits_bps: dict[Stream, float] = field(default_factory=dict)
    wanted: set[Stream] = field(default_factory=set)

    def take_wanted(self) -> AbstractSet[Stream]:
        wanted, self.wanted = self.wanted, set()
        return wanted

    def on_watched(self, limits_bps: Any) -> None:
        self.limits_bps = dict(limits_bps)

    def on_keyframe_wanted(self, stream: Stream) -> None:
        self.wanted.add(stream)

    def on_joined(self, peer: Peer) -> None: ...
    def on_left(self, peer: Peer) -> None: ...
    def on_pose(self, peer: Peer, payload: bytes) -> None: ...
    def on_status(self, peer: Peer, text: str) -> None: ...
    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None: ...


def show(
    pictures: Sequence[Image],
    frames_per_s: float,
    network: Sequence[str],
    seconds: float,
    *,
    follows: bool,
    executable: Path | None = None,
) -> Displayed:
    """Show a browser these pictures again and again over a network, options of `netrelay run`, for so long.

    Without options nothing is between. executable: what starts the browser there. Where it does not follow, the
    receiver's reports change nothing. Raises Unavailable where there is no TUN device.
    """
    with contextlib.ExitStack() as stack:
        if not follows:
            for deaf in ("on_report", "on_estimate"):
                stack.enter_context(mock.patch.object(RateControl, deaf))
        inside = executable
        if network:
            stack.enter_context(_network(network))
            inside = stack.enter_context(_chromium_inside())
        return asyncio.run(_show(pictures, frames_per_s, seconds, inside))


@contextlib.contextmanager
def _network(options: Sequence[str]) -> Iterator[None]:
    command = [sys.executable, "-m", "tools.netrelay", "run", _NAMESPACE, "--number", str(_NUMBER), *options]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as relay:
        assert relay.stderr is not None
        said = relay.stderr.readline()
        try:
            if not said.startswith("ready"):
                raise Unavailable(said.strip())
            yield
        finally:
            relay.terminate()


@contextlib.contextmanager
def _chromium_inside() -> Iterator[Path]:
    """What starts a Chromium in the namespace."""
    with tempfile.TemporaryDirectory() as folder:
        inside = Path(folder) / "chromium"
        inside.write_text(f'#!/bin/sh\nexec ip netns exec {_NAMESPACE} {chromium_path()} "$@"\n')
        inside.chmod(0o755)
        yield inside


async def _show(
    pictures: Sequence[Image], frames_per_s: float, seconds: float, executable: Path | None
) -> Displayed:
    peers, orders = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list), _Orders()
    peers.attach(orders)
    async with watching_page(executable) as page:
        answer = await peers.answer(Role.BROWSER, await offer_of(page), "ana")
        # Then a picture's time stamp is the same at both ends.
        with mock.patch.object(rtcrtpsender, "random32", return_value=0):
            await accept(page, answer)
            drawn_ms, (kbit_s, memory_mb) = await _send(
                pictures, frames_per_s, SETTLE_S + seconds, peers, orders
            )
        pts = np.array(list(drawn_ms))
        at_ms, delay_ms, shown_pts = await shown(page, drawn_ms)
        await peers.close()
    ticks = (np.searchsorted(pts, shown_pts) % len(pictures)).tolist()
    return Displayed(at_ms, delay_ms, kbit_s, memory_mb, ticks)


async def _send(
    pictures: Sequence[Image], frames_per_s: float, seconds: float, peers: Peers, orders: _Orders
) -> tuple[dict[int, float], tuple[float, tuple[float, float]]]:
    """Return when each picture was drawn, by its time stamp; kbit/s that were encoded for the browser, and memory."""
    encoders = StreamEncoders(frames_per_s, FAST)
    drawn_ms: dict[int, float] = {}
    begun_s, size_bytes, memory_mb = clock.monotonic_s(), 0, 0.0
    (peer,) = peers
    for number in range(int(seconds * frames_per_s)):
        now_s = clock.monotonic_s()
        now_ms = clock.wall_ns() * 1e-6
        peer.heard_s = now_s
        picture_rgb = pictures[number % len(pictures)]
        for encoded in encoders.encode(picture_rgb, now_s, orders.limits_bps, orders.take_wanted()):
            drawn_ms[encoded.pts & 0xFFFFFFFF] = now_ms
            peers.put(encoded)
            size_bytes += len(encoded.data) if encoded.stream == peer.stream else 0
        if not memory_mb and now_s - begun_s > SETTLE_S:
            memory_mb = _peak_memory_mb()
        await asyncio.sleep(max(0.0, begun_s + (number + 1) / frames_per_s - clock.monotonic_s()))
    kbit_s = 8e-3 * size_bytes / (clock.monotonic_s() - begun_s)
    return drawn_ms, (kbit_s, (memory_mb, _peak_memory_mb()))


def _peak_memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
