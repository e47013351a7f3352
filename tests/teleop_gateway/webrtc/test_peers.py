"""Who stays connected to a seat: no peer that has fallen silent, and none that drove before it changed hands."""

from __future__ import annotations

import asyncio
import math
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
from mart.teleop_gateway.video.encoder import RECORDED, Codec
from mart.teleop_gateway.voice.lanes import LanePacket
from mart.teleop_gateway.webrtc import peers as module
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peers import MAX_VIEWERS, SILENT_S, Peers
from mart.teleop_gateway.webrtc.status_broadcaster import StatusBroadcaster
from tests.teleop_gateway.webrtc.stub_peers import CONNECTS, StubPeer, seated


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


@pytest.mark.parametrize(
    ("draws", "watches", "phase", "rests"),
    [
        (True, False, EPISODE_PHASE_PRACTICE, True),
        (True, True, EPISODE_PHASE_PRACTICE, False),
        (False, False, EPISODE_PHASE_PRACTICE, False),
        (True, False, EPISODE_PHASE_COUNTDOWN, True),
        (False, False, EPISODE_PHASE_RECORDING, False),
        (True, False, EPISODE_PHASE_ENDED, True),
    ],
)
def test_a_view_rests_where_pages_draw_and_nobody_watches(
    draws: bool, watches: bool, phase: EpisodePhase, rests: bool
) -> None:
    async def body() -> None:
        peers, _ = await seated()
        views = mock.MagicMock()
        broadcaster = StatusBroadcaster(peers, cast("Any", None), views, views, cast("Any", None))
        browser, _, viewer = cast("list[StubPeer]", list(peers))
        browser.draws, viewer.codec = draws, Codec.H264 if watches else None
        broadcaster.status = RoomStatus(episode={"phase": phase})
        broadcaster.rest_where_unneeded()
        views.set_resting.assert_called_once_with(rests)

    asyncio.run(body())


def test_what_one_says_is_heard_on_no_device_of_ones_own_and_on_no_phone() -> None:
    async def body() -> None:
        peers, _ = await seated()
        await peers.answer(Role.VIEWER, CONNECTS, "ben")
        browser, phone, own, ben = cast("list[StubPeer]", list(peers))
        peers.play(LanePacket(0, "said-by-ana", 1, b"hello"), cast("Peer", phone))
        assert [len(peer.played) for peer in (browser, phone, own, ben)] == [0, 0, 0, 1]
        peers.play(LanePacket(0, "said-elsewhere", 1, b"hello"), None)
        assert [len(peer.played) for peer in (browser, phone, own, ben)] == [1, 0, 1, 2]

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
        broadcaster = StatusBroadcaster(cast("Any", peers), cast("Any", Undriven()), *[anything] * 3)
        broadcaster.status = RoomStatus(room="room-1")
        telling = asyncio.create_task(broadcaster.run())
        await asyncio.wait_for(peers.looked.wait(), 20.0)
        telling.cancel()

    asyncio.run(body())
