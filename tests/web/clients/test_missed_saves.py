"""A saved episode whose event was lost on the way is told to the pages all the same."""

from __future__ import annotations

import asyncio

import pytest

from mart.protocol import codec, keys
from mart.protocol.errors import Corrupt
from mart.protocol.messages import (
    BARRIER_PHASE_RUNNING,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    CatalogueReply,
    CatalogueRequest,
    EpisodePhase,
    RecordedEpisode,
    RoomStatus,
    error_message,
)
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Request
from mart.runtime.bus.memory import MemoryBus
from mart.web.api.app_state import AppState
from mart.web.clients.missed_saves import MissedSaves
from mart.web.lobby.lobby import Lobby

pytestmark = pytest.mark.anyio

BEGAN_NS = 1_700_000_000_000_000_000
LATER_S = 60.0


class Catalogue:
    """A catalogue on the bus with a list that a test fills."""

    def __init__(self, bus: MemoryBus) -> None:
        self.episodes: list[RecordedEpisode] = []
        self.fault: Corrupt | None = None
        self.asked: list[CatalogueRequest] = []
        bus.serve(keys.catalogue("catalogue-1"), self._answer)
        self.token = bus.announce(keys.alive(ServiceKind.CATALOGUE, "catalogue-1"))

    def _answer(self, request: Request) -> None:
        self.asked.append(codec.decode(CatalogueRequest, request.payload))
        reply = CatalogueReply(listing=CatalogueReply.Listing(episodes=self.episodes))
        if self.fault is not None:
            reply = CatalogueReply(error=error_message(self.fault))
        request.reply(codec.encode(reply))


@pytest.fixture
async def catalogue(app_state: AppState, bus: MemoryBus) -> Catalogue:
    catalogue = Catalogue(bus)
    await asyncio.sleep(0)  # its liveliness token is on its way
    return catalogue


@pytest.fixture
def missed(app_state: AppState) -> MissedSaves:
    """Looks for episode 3 of room-1, which has ended a minute ago and of which no event came."""
    app_state.lobby.see_alive(keys.alive(ServiceKind.SIM, "room-1"), True)
    for phase in (EPISODE_PHASE_RECORDING, EPISODE_PHASE_ENDED, EPISODE_PHASE_PRACTICE):
        app_state.lobby.see_status(status(phase), 0.0)
    return MissedSaves(app_state.lobby, app_state.catalogue)


def status(phase: EpisodePhase) -> RoomStatus:
    told = RoomStatus(
        room="room-1", task="two_arm_multi_cube_lifting", barrier=BARRIER_PHASE_RUNNING, wall_ns=BEGAN_NS
    )
    told.episode.phase, told.episode.number = phase, 3
    return told


def recorded(number: int = 3, started_ns: int = BEGAN_NS) -> RecordedEpisode:
    path = f"2026-11-22/room-1-{number:04}-x.mcap"
    episode = RecordedEpisode(path=path, room="room-1", number=number, started_ns=started_ns, size_bytes=9)
    episode.outcome, episode.verdict, episode.simulated_s = "success", "verified", 8.0
    return episode


async def told_by(missed: MissedSaves, lobby: Lobby, now_s: float = LATER_S) -> list[dict[str, object]]:
    with lobby.listeners.listen() as listener:
        await missed.ask(now_s)
        return listener.take_events()


async def test_the_pages_are_told_once(
    app_state: AppState, catalogue: Catalogue, missed: MissedSaves
) -> None:
    catalogue.episodes = [recorded(4), recorded()]
    (event,) = await told_by(missed, app_state.lobby)
    assert event == {
        "id": event["id"],
        "room": "room-1",
        "kind": "episode_saved",
        "number": 3,
        "path": "episodes/2026-11-22/room-1-0003-x.mcap",
        "verified": True,
        "verdict": "verified",
        "size_bytes": 9,
        "outcome": "success",
    }
    assert await told_by(missed, app_state.lobby, now_s=LATER_S + 10) == []
    assert len(catalogue.asked) == 1


async def test_a_file_of_another_time_with_the_same_number_is_not_taken_for_it(
    app_state: AppState, catalogue: Catalogue, missed: MissedSaves
) -> None:
    catalogue.episodes = [recorded(started_ns=BEGAN_NS - 3600 * 10**9)]
    assert await told_by(missed, app_state.lobby) == []


async def test_what_is_not_saved_yet_is_asked_for_again(
    app_state: AppState, catalogue: Catalogue, missed: MissedSaves
) -> None:
    assert await told_by(missed, app_state.lobby) == []
    catalogue.fault = Corrupt("The folder cannot be read.")
    assert await told_by(missed, app_state.lobby, now_s=LATER_S + 10) == []
    catalogue.fault, catalogue.episodes = None, [recorded()]
    assert len(await told_by(missed, app_state.lobby, now_s=LATER_S + 20)) == 1


async def test_without_a_catalogue_it_stays_due(
    app_state: AppState, catalogue: Catalogue, missed: MissedSaves
) -> None:
    app_state.lobby.see_alive(keys.alive(ServiceKind.CATALOGUE, "catalogue-1"), False)
    assert await told_by(missed, app_state.lobby) == []
    app_state.lobby.see_alive(keys.alive(ServiceKind.CATALOGUE, "catalogue-1"), True)
    catalogue.episodes = [recorded()]
    assert len(await told_by(missed, app_state.lobby)) == 1
