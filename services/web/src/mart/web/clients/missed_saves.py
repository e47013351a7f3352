"""Saved episodes of which no event came are asked of the catalogue, so that no page waits for a word that was lost."""

from __future__ import annotations

import asyncio
import logging
from collections import defaultdict

from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.protocol.messages import CatalogueRequest
from mart.runtime.awaited_saves import AwaitedSave, saved_event
from mart.web.clients.catalogue_client import CatalogueClient
from mart.web.lobby.lobby import Lobby

_log = logging.getLogger(__name__)

_LOOK_EVERY_S = 1.0
_LISTED = 64


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
            event = saved_event(save, listed)
            if event is not None:
                _log.info("%s: no event told that episode %d is saved", room, save.number)
                self._lobby.see_event(event, clock.monotonic_s(), clock.wall_ns())
