"""Who stays connected to a seat: no peer that has fallen silent, and none that drove before it changed hands."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping
from typing import Any, cast
from unittest import mock

import pytest

from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    EpisodePhase,
    RoomStatus,
)
from mart.protocol.tokens import Role
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.video.encoder import RECORDED, Audience, Codec, Stream
from mart.teleop_gateway.webrtc import peers as module
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peers import MAX_VIEWERS, SILENT_S, Peers
from mart.teleop_gateway.webrtc.status_broadcaster import StatusBroadcaster

CONNECTS = "an offer of a page that connects"


class StubPeer:
    """A peer without a connection, last heard at 0 s."""

    codec: Codec | None = None
    track = None

    def __init__(self, role: Role, _listener: object, _ice_servers: object, holder_id: str) -> None:
        self.role = role
        self.holder_id = holder_id
        self.heard_s = 0.0
        self.is_connected = False
        self.is_closed = False
        self.draws = False
        self.poses = b""
        self.audience = Audience.EVERYONE
        self.limit_bps = math.inf

    @property
    def stream(self) -> Stream | None:
        return None if self.codec is None or self.draws else Stream(self.codec, self.audience)

    def set_audience(self, audience: Audience) -> None:
        self.audience = audience

    async def answer(self, offer_sdp: str) -> str:
        await asyncio.sleep(0)
        self.is_connected = offer_sdp == CONNECTS
        return offer_sdp

    async def close(self) -> None:
        self.is_closed = True

    def send_status(self, text: str) -> None:
        """Nobody hears it."""

    def set_draws(self, draws: bool) -> None:
        self.draws = draws

    def send_poses(self, message: bytes) -> None:
        self.poses = message


class Leavers:
    """Keeps the roles of those that left."""

    def __init__(self) -> None:
        self.left: list[Role] = []
        self.wished: list[Stream] = []

    def on_joined(self, peer: Peer) -> None:
        peer.heard_s = {Role.BROWSER: 100.0, Role.PHONE: 90.0, Role.VIEWER: 89.0}[peer.role]

    def on_left(self, peer: Peer) -> None:
        self.left.append(peer.role)

    def on_watched(self, limits_bps: Mapping[Stream, float]) -> None:
        """Nobody watches."""

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Nobody drives."""

    def on_status(self, peer: Peer, text: str) -> None:
        """Nobody speaks."""

    def on_keyframe_wanted(self, stream: Stream) -> None:
        self.wished.append(stream)


async def seated() -> tuple[Peers, Leavers]:
    """A browser that was heard at 100 s, a phone at 90 s, and a viewer at 89 s."""
    peers = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list)
    leavers = Leavers()
    peers.attach(leavers)
    for role in (Role.BROWSER, Role.PHONE, Role.VIEWER):
        await peers.answer(role, "", "ana")
    return peers, leavers


@pytest.fixture(autouse=True)
def _without_connections(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "Peer", StubPeer)


@pytest.mark.parametrize(
    ("now_s", "gone"),
    [
        (89.0 + SILENT_S, []),
        (90.0 + SILENT_S, [Role.VIEWER]),
        (100.0 + SILENT_S, [Role.PHONE, Role.VIEWER]),
        (101.0 + SILENT_S, [Role.BROWSER, Role.PHONE, Role.VIEWER]),
    ],
)
def test_those_that_were_silent_for_too_long_are_dropped(now_s: float, gone: list[Role]) -> None:
    async def body() -> None:
        peers, leavers = await seated()
        peers.drop_silent(now_s)
        assert leavers.left == gone
        assert {peer.role for peer in peers} == set(Role) - set(gone)

    asyncio.run(body())


def test_a_seat_that_changes_hands_keeps_its_viewers() -> None:
    async def body() -> None:
        peers, leavers = await seated()
        peers.drop_driving()
        assert leavers.left == [Role.BROWSER, Role.PHONE]
        assert [peer.role for peer in peers] == [Role.VIEWER]

    asyncio.run(body())


def test_a_page_that_draws_watches_no_video_and_is_told_poses() -> None:
    async def body() -> None:
        peers, _ = await seated()
        browser, _, viewer = cast("list[StubPeer]", list(peers))
        browser.codec = viewer.codec = Codec.H264
        assert (peers.any_draws, peers.holder_draws, peers.streams()) == (False, False, {RECORDED: math.inf})
        peers.set_draws(cast("Peer", viewer), True)
        assert (peers.any_draws, peers.holder_draws, peers.streams()) == (True, False, {RECORDED: math.inf})
        peers.set_draws(cast("Peer", browser), True)
        assert (peers.any_draws, peers.holder_draws, peers.streams()) == (True, True, {})
        peers.set_draws(cast("Peer", viewer), False)
        peers.put_poses(b"poses")
        assert (browser.poses, viewer.poses) == (b"poses", b"")

    asyncio.run(body())


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


@pytest.mark.parametrize(
    ("draws", "watches", "phase", "rests"),
    [
        (True, False, EPISODE_PHASE_PRACTICE, True),
        (True, True, EPISODE_PHASE_PRACTICE, False),
        (False, False, EPISODE_PHASE_PRACTICE, False),
        (True, False, EPISODE_PHASE_COUNTDOWN, False),
        (True, False, EPISODE_PHASE_RECORDING, False),
        (True, False, EPISODE_PHASE_ENDED, True),
    ],
)
def test_a_view_rests_where_pages_draw_nobody_watches_and_nothing_is_recorded(
    draws: bool, watches: bool, phase: EpisodePhase, rests: bool
) -> None:
    async def body() -> None:
        peers, _ = await seated()
        views = mock.MagicMock()
        broadcaster = StatusBroadcaster(peers, cast("Any", None), views, cast("Any", None))
        browser, _, viewer = cast("list[StubPeer]", list(peers))
        browser.draws, viewer.codec = draws, Codec.H264 if watches else None
        broadcaster.status = RoomStatus(episode={"phase": phase})
        broadcaster.rest_where_unneeded()
        views.set_resting.assert_called_once_with(rests)

    asyncio.run(body())


async def watch(peers: Peers, *holders: str, offer: str = CONNECTS) -> list[BaseException | str]:
    """Offers of these people to watch, all at once: answers, or why there is none."""
    offers = (peers.answer(Role.VIEWER, offer, holder) for holder in holders)
    return await asyncio.gather(*offers, return_exceptions=True)


def watchers(peers: Peers) -> list[str]:
    return [peer.holder_id for peer in peers if peer.role is Role.VIEWER]


def test_no_more_watch_than_may_however_many_come_at_once() -> None:
    async def body() -> None:
        peers = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list)
        await watch(peers, *(f"person-{number}" for number in range(14)))
        assert len(watchers(peers)) == MAX_VIEWERS
        (refused,) = await watch(peers, "another")
        assert isinstance(refused, Conflict)

    asyncio.run(body())


def test_offers_that_never_connect_keep_nobody_out() -> None:
    async def body() -> None:
        peers = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list)
        await watch(peers, *(f"person-{number}" for number in range(20)), offer="never connects")
        honest = [f"honest-{number}" for number in range(MAX_VIEWERS)]
        for person in honest:
            assert await watch(peers, person) == [CONNECTS]
        assert watchers(peers) == honest

    asyncio.run(body())


def test_one_person_has_two_places_and_the_newest_count() -> None:
    async def body() -> None:
        peers = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list)
        await watch(peers, "ben")
        for _ in range(5):
            assert await watch(peers, "ana") == [CONNECTS]
        assert watchers(peers) == ["ben", "ana", "ana"]

    asyncio.run(body())


def test_an_offer_that_cannot_be_answered_gives_its_place_back(monkeypatch: pytest.MonkeyPatch) -> None:
    async def refuse(_peer: StubPeer, _sdp: str) -> str:
        raise InvalidInput("No offer.")

    async def body() -> None:
        peers = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list)
        monkeypatch.setattr(StubPeer, "answer", refuse)
        (refused,) = await watch(peers, "ana")
        assert isinstance(refused, InvalidInput)
        assert watchers(peers) == []

    asyncio.run(body())


def test_who_is_told_how_things_stand_is_also_looked_after() -> None:
    class Counting:
        def __init__(self) -> None:
            self.looked = asyncio.Event()

        def drop_silent(self, now_s: float) -> None:
            assert now_s > 0.0
            self.looked.set()

    class Undriven:
        driving = None

    async def body() -> None:
        peers = Counting()
        anything = cast("Any", None)
        broadcaster = StatusBroadcaster(cast("Any", peers), cast("Any", Undriven()), anything, anything)
        broadcaster.status = RoomStatus(room="room-1")
        telling = asyncio.create_task(broadcaster.run())
        await asyncio.wait_for(peers.looked.wait(), 20.0)
        telling.cancel()

    asyncio.run(body())
