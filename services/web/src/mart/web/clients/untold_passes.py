"""Whoever passes the practice course while they sit in another room is known there, too, without leaving the seat."""

from __future__ import annotations

import asyncio
import logging
from functools import partial

from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.protocol.holders import is_held_by
from mart.protocol.messages import OPERATOR_HUMAN
from mart.web.access.user_sessions import UserSessions
from mart.web.clients.room_client import RoomRequester
from mart.web.lobby.lobby import Lobby

_log = logging.getLogger(__name__)

_LOOK_EVERY_S = 1.0


class UntoldPasses:
    """Tell rooms that ask for the course of those who sit there and have passed it meanwhile."""

    def __init__(self, lobby: Lobby, user_sessions: UserSessions, rooms: RoomRequester) -> None:
        self._lobby, self._user_sessions, self._rooms = lobby, user_sessions, rooms

    async def keep_telling(self) -> None:
        """Tell once a second of whom there is to tell, until cancelled."""
        while True:
            try:
                await self.tell(clock.monotonic_s())
            except MartError as error:
                _log.warning("Who has passed the practice course is not told yet: %s", error)
            await asyncio.sleep(_LOOK_EVERY_S)

    async def tell(self, now_s: float) -> None:
        """Claim for its holder each seat that a room takes for one who practises only, though they have passed.

        Raises what the room reports, and Unavailable where the sessions cannot be read; the rest is told later.
        """
        for room in self._lobby.rooms.names(now_s):
            status = self._lobby.rooms.status(room, now_s)
            if not status.course_required or status.practice:
                continue
            for seat in status.seats:
                if seat.operator == OPERATOR_HUMAN and not seat.passed_course:
                    user = self._user_sessions.find_passed(partial(is_held_by, seat))
                    if user is not None:
                        await self._rooms.take_seat(room, seat.arm, user)
