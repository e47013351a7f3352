"""An episode that is saved is heard of once, though the word of it is said twice, or lost."""

from __future__ import annotations

import contextlib
import queue
from collections import Counter
from collections.abc import Iterator

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import (
    EPISODE_PHASE_ENDED,
    OUTCOME_SUCCESS,
    CatalogueReply,
    CatalogueRequest,
    Episode,
    Event,
    RecordedEpisode,
    RoomStatus,
)
from mart.protocol.vocabulary import EpisodeOutcome, ServiceKind, Verdict
from mart.runtime import awaited_saves
from mart.runtime.bus import Bus, Request
from mart.runtime.bus.memory import MemoryNetwork
from mart.sim.room import save_follower
from mart.sim.room.save_follower import SaveFollower

ROOM = "room-1"


@pytest.fixture
def bus() -> Bus:
    return MemoryNetwork().connect()


@pytest.fixture
def heard(bus: Bus, monkeypatch: pytest.MonkeyPatch) -> Iterator[queue.Queue[Event.EpisodeSaved]]:
    monkeypatch.setattr(awaited_saves, "ASKED_AFTER_S", 0.0)
    monkeypatch.setattr(save_follower, "_LOOK_EVERY_S", 0.01)
    saved: queue.Queue[Event.EpisodeSaved] = queue.Queue()
    with contextlib.closing(SaveFollower(bus, ROOM, saved.put, Counter())):
        yield saved


def tell(bus: Bus, number: int) -> None:
    event = Event(room=ROOM, episode_saved=Event.EpisodeSaved(number=number, verified=True))
    bus.publisher(keys.event(ROOM)).put(codec.encode(event))


def test_what_is_told_twice_counts_once(bus: Bus, heard: queue.Queue[Event.EpisodeSaved]) -> None:
    for number in (1, 1, 2):
        tell(bus, number)
    assert [heard.get_nowait().number for _ in range(heard.qsize())] == [1, 2]


def test_what_nobody_told_is_asked_of_the_catalogue(bus: Bus, heard: queue.Queue[Event.EpisodeSaved]) -> None:
    def list_episodes(request: Request) -> None:
        assert codec.decode(CatalogueRequest, request.payload).list.room == ROOM
        listed = RecordedEpisode(
            room=ROOM,
            number=7,
            path="2026-01-01/room-1-0007-task.mcap",
            outcome=EpisodeOutcome.SUCCESS,
            verdict=Verdict.VERIFIED,
            started_ns=10**18,
        )
        listing = CatalogueReply.Listing(episodes=[listed])
        request.reply(codec.encode(CatalogueReply(listing=listing)))

    bus.serve(keys.catalogue("catalogue-1"), list_episodes)
    bus.announce(keys.alive(ServiceKind.CATALOGUE, "catalogue-1"))
    ended = Episode(number=7, phase=EPISODE_PHASE_ENDED, outcome=OUTCOME_SUCCESS)
    status = RoomStatus(room=ROOM, episode=ended, wall_ns=10**18)
    bus.publisher(keys.status(ROOM)).put(codec.encode(status))
    found = heard.get(timeout=10.0)
    assert (found.number, found.verified, found.outcome) == (7, True, OUTCOME_SUCCESS)
    tell(bus, 7)  # late after all
    assert heard.empty()
