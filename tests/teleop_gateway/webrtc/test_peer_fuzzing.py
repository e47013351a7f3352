"""Offers and data channels: whatever a peer sends costs that peer its connection at most.

Minutes of it, by hand: `.venv/bin/pytest tests/teleop_gateway/webrtc/test_peer_fuzzing.py --hypothesis-profile fuzz`.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import logging
import os
import re
from collections.abc import AsyncIterator, Mapping

import pytest
from aiortc.rtcsctptransport import WEBRTC_BINARY, WEBRTC_STRING
from hypothesis import example, given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.protocol.tokens import Role
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.video.encoder import Stream
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peers import Peers
from tests.support.fuzzing import fuzzing
from tests.teleop_gateway.browser import Browser

pytestmark = pytest.mark.system


class Listener:
    """Reads what peers say, as a seat does, and keeps who left."""

    def __init__(self) -> None:
        self.phone_heard = asyncio.Event()
        self.left = asyncio.Event()

    def on_joined(self, peer: Peer) -> None:
        """Nothing to do."""

    def on_left(self, peer: Peer) -> None:
        self.left.set()

    def on_watched(self, limits_bps: Mapping[Stream, float]) -> None:
        """Nothing to do."""

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Nothing to do."""

    def on_status(self, peer: Peer, text: str) -> None:
        if peer.role is Role.PHONE:
            self.phone_heard.set()
        with contextlib.suppress(InvalidInput):
            status_channel.parse(text)

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        """Nobody hears it."""

    def on_keyframe_wanted(self, stream: Stream) -> None:
        """Nothing to do."""


@contextlib.asynccontextmanager
async def seat() -> AsyncIterator[tuple[Peers, Listener]]:
    peers, listener = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list), Listener()
    peers.attach(listener)
    try:
        yield peers, listener
    finally:
        await peers.close()


@contextlib.asynccontextmanager
async def joined(peers: Peers, role: Role) -> AsyncIterator[Browser]:
    browser = Browser(role)
    try:
        await browser.connect(lambda sdp: peers.answer(role, sdp, role.value))
        yield browser
    finally:
        await browser.close()


async def send_raw(browser: Browser, kind: int, data: bytes) -> None:
    """A message of the status channel that no browser would let a page send."""
    sctp, stream = browser.connection.sctp, browser.status.id
    assert sctp is not None
    assert stream is not None
    await sctp._send(stream, kind, data, expiry=None, max_retransmits=0, ordered=False)


def test_who_sends_what_cannot_be_read_is_let_go_in_one_line_and_nobody_else(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def body() -> None:
        async with (
            seat() as (peers, listener),
            joined(peers, Role.PHONE) as phone,
            joined(peers, Role.BROWSER) as browser,
        ):
            await send_raw(browser, WEBRTC_STRING, b"\xff\xfe no text")
            await asyncio.wait_for(listener.left.wait(), 30)
            assert [peer.role for peer in peers] == [Role.PHONE]
            phone.status.send(status_channel.ping(1.0))
            await asyncio.wait_for(listener.phone_heard.wait(), 30)

    with caplog.at_level(logging.INFO):
        asyncio.run(body())
    assert caplog.text.count("cannot be read") == 1
    assert "Traceback" not in caplog.text


def offer() -> str:
    async def made() -> str:
        browser = Browser()
        try:
            await browser.connection.setLocalDescription(await browser.connection.createOffer())
            return str(browser.connection.localDescription.sdp)
        finally:
            await browser.close()

    return asyncio.run(made())


LINES = offer().splitlines()
_JUNK = st.sampled_from(
    [
        "",
        "a=",
        "m=",
        "a=candidate:",
        "a=fingerprint:",
        "m=video",
        "a=extmap:999999 urn:x",
        "a=rtpmap:x",
        "\0",
        "é",
    ]
)
_NUMBER = st.sampled_from(["-1", "0", "65536", str(2**63), str(10**40), "x", ""])


def _always(number: str, _: re.Match[str]) -> str:
    return number


def without(start: str) -> str:
    return "\r\n".join(line for line in LINES if not line.startswith(start)) + "\r\n"


@st.composite
def spoilt_offers(draw: st.DrawFn) -> str:
    """An offer of a browser with a few lines lost, doubled, moved, spoilt or made up."""
    lines = list(LINES)
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, len(lines) - 1))
        match draw(st.sampled_from(["lose", "double", "move", "number", "cut", "junk", "text"])):
            case "lose" if len(lines) > 1:
                del lines[at]
            case "double":
                lines[at:at] = [lines[at]] * draw(st.integers(1, 40))
            case "move":
                lines.insert(draw(st.integers(0, len(lines) - 1)), lines.pop(at))
            case "number":
                number = draw(_NUMBER)
                lines[at] = re.sub(
                    r"\d+", functools.partial(_always, number), lines[at], count=draw(st.integers(1, 3))
                )
            case "cut":
                lines[at] = lines[at][: draw(st.integers(0, len(lines[at])))]
            case "junk":
                lines.insert(at, draw(_JUNK))
            case "text":
                lines.insert(at, draw(st.text(max_size=40)))
    return "\r\n".join(lines) + "\r\n"


def open_files() -> int:
    return len(os.listdir("/proc/self/fd"))


@fuzzing(examples=25)
@given(sdp=spoilt_offers(), role=st.sampled_from(Role))
@example(sdp=without("m=application"), role=Role.BROWSER)
@example(sdp=without("m=video"), role=Role.BROWSER)
def test_an_offer_is_answered_or_refused_in_words(sdp: str, role: Role) -> None:
    async def body() -> None:
        async with seat() as (peers, _listener), asyncio.timeout(60):
            with contextlib.suppress(InvalidInput):
                assert (await peers.answer(role, sdp, "ana")).startswith("v=0")
                return
            assert list(peers) == []

    before = open_files()
    asyncio.run(body())
    assert open_files() <= before


_MESSAGES = st.lists(
    st.tuples(
        st.sampled_from([WEBRTC_STRING, WEBRTC_BINARY, 50, 56, 57, 0, 2**32 - 1]),
        st.one_of(st.binary(max_size=80), st.text(max_size=40).map(str.encode)),
    ),
    min_size=1,
    max_size=8,
)


@fuzzing(examples=10)
@given(messages=_MESSAGES)
def test_a_peers_messages_cost_it_its_own_connection_at_most(messages: list[tuple[int, bytes]]) -> None:
    async def body() -> None:
        async with (
            asyncio.timeout(60),
            seat() as (peers, listener),
            joined(peers, Role.PHONE) as phone,
            joined(peers, Role.BROWSER) as browser,
        ):
            for kind, data in messages:
                await send_raw(browser, kind, data)
            phone.status.send(status_channel.ping(7.0))
            await listener.phone_heard.wait()

    asyncio.run(body())
