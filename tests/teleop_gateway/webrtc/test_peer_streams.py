"""Which stream each peer of a seat is shown: nobody's bad link spoils another's picture."""

from __future__ import annotations

import asyncio
import math
from typing import cast

import pytest

from mart.protocol.tokens import Role
from mart.teleop_gateway.video.encoder import RECORDED, Audience, Codec, Stream
from mart.teleop_gateway.webrtc import peers as module
from mart.teleop_gateway.webrtc.peer import Peer
from tests.teleop_gateway.webrtc.stub_peers import StubPeer, seated


@pytest.fixture(autouse=True)
def _without_connections(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "Peer", StubPeer)


def test_whoever_has_a_bad_link_gets_a_stream_of_their_own_and_spoils_no_other() -> None:
    """The holder's and the viewers' bad links are apart, and a viewer with a good one keeps everyone's pictures."""

    async def body() -> None:
        peers, _ = await seated()
        await peers.answer(Role.VIEWER, "", "ben")
        await peers.answer(Role.VIEWER, "", "cleo")
        browser, _, near, far, farther = cast("list[StubPeer]", list(peers))
        for peer in (browser, near, far, farther):
            peer.codec = Codec.H264
        far.limit_bps, farther.limit_bps = 500_000.0, 200_000.0
        peers.on_limit()
        assert peers.streams() == {RECORDED: math.inf, Stream(Codec.H264, Audience.VIEWERS): 200_000.0}
        assert [peer.audience for peer in (browser, near)] == [Audience.EVERYONE] * 2
        browser.limit_bps = 300_000.0
        peers.on_limit()
        assert peers.streams()[Stream(Codec.H264, Audience.HOLDER)] == 300_000.0
        assert peers.streams()[RECORDED] == math.inf
        for peer in (browser, near, far, farther):
            peer.limit_bps = math.inf
        peers.on_limit()
        assert peers.streams() == {RECORDED: math.inf}

    asyncio.run(body())


def test_viewers_wish_for_one_keyframe_of_everyones_pictures_a_second() -> None:
    async def body() -> None:
        peers, listener = await seated()
        browser, _, viewer = cast("list[StubPeer]", list(peers))
        browser.codec = viewer.codec = Codec.H264
        for _ in range(20):
            peers.on_keyframe_wanted(cast("Peer", viewer))
        assert listener.wished == [RECORDED]
        for _ in range(20):
            peers.on_keyframe_wanted(cast("Peer", browser))
        assert listener.wished == [RECORDED] * 21
        viewer.audience = Audience.VIEWERS
        peers.on_keyframe_wanted(cast("Peer", viewer))
        assert listener.wished[-1] == Stream(Codec.H264, Audience.VIEWERS)

    asyncio.run(body())
