"""Saved episodes of which no event came are asked of the catalogue, so that no page waits for a word that was lost."""

from __future__ import annotations

import asyncio
import logging
from collections import defaultdict

from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.protocol.messages import CatalogueRequest, Event, RecordedEpisode, outcome_from_word
from mart.protocol.vocabulary import EpisodeOutcome, Verdict
from mart.web.clients.catalogue_client import CatalogueClient
from mart.web.lobby.awaited_saves import AwaitedSave
from mart.web.lobby.lobby import Lobby

_log = logging.getLogger(__name__)

_LOOK_EVERY_S = 1.0
_LISTED = 64
_SLACK_S = (
    60.0  # a file of the same number that ended earlier than this before the episode ran is another one's
)
_FOLDER = "episodes"  # an event names a file from the data folder on, the catalogue from this one on


class MissedSaves:
    """Asks for the episodes that a lobby awaits, and tells it of those that are saved."""

    def __init__(self, lobby: Lobby, catalogue: CatalogueClient) -> None:
        self._lobby, self._catalogue = lobby, catalogue

    async def keep_asking(self) -> None:
        """Ask for what is due once a second, until cancelled."""
        while True:
            await self.ask(clock.monotonic_s())
            await asyncio.sleep(_LOOK_EVERY_S)

    async def ask(self, now_s: float) -> None:
        """Ask for what is due at `now_s`; where no catalogue answers it is due again later."""
        by_room: defaultdict[str, list[AwaitedSave]] = defaultdict(list)
        if self._catalogue.is_running:
            for save in self._lobby.awaited_saves.take_due(now_s):
                by_room[save.room].append(save)
        for room, saves in by_room.items():
            try:
                await self._ask_for(room, saves)
            except MartError as error:
                _log.warning("%s: whether its episodes are saved is not known yet: %s", room, error)

    async def _ask_for(self, room: str, saves: list[AwaitedSave]) -> None:
        request = CatalogueRequest(list=CatalogueRequest.List(room=room, count=_LISTED))
        listed = (await self._catalogue.ask(request)).listing.episodes
        for save in saves:
            found = next((episode for episode in listed if _is_of(save, episode)), None)
            if found is not None:
                _log.info("%s: no event told that episode %d is saved", room, save.number)
                self._lobby.see_event(_saved_event(found), clock.monotonic_s(), clock.wall_ns())


def _is_of(save: AwaitedSave, episode: RecordedEpisode) -> bool:
    ended_ns = episode.started_ns + (episode.simulated_s + _SLACK_S) * 1e9
    return (episode.room, episode.number) == (save.room, save.number) and ended_ns >= save.seen_ns


def _saved_event(episode: RecordedEpisode) -> Event:
    saved = Event.EpisodeSaved(
        number=episode.number,
        path=f"{_FOLDER}/{episode.path}",
        verified=episode.verdict == Verdict.VERIFIED,
        verdict=episode.verdict,
        size_bytes=episode.size_bytes,
    )
    if episode.outcome != EpisodeOutcome.UNSPECIFIED:
        saved.outcome = outcome_from_word(episode.outcome)
    return Event(room=episode.room, episode_saved=saved)
