"""The bus keeps the lobby current: what rooms and services say is decoded and handed over."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable

from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

from mart.protocol import clock, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import Event, RoomStatus
from mart.protocol.received import decode_received, require_room
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Closable, Handler, Sample
from mart.runtime.rate_limit import RateLimit
from mart.web.lobby import thumbnails
from mart.web.lobby.lobby import Lobby

_log = logging.getLogger(__name__)

_MAX_MESSAGE_BYTES = 64 * 1024
_MAX_THUMBNAIL_BYTES = thumbnails.MAX_BYTES + 1024
_SETTLE_S = 2.0
_ASK_EVERY_S = 2.0
_LOOK_EVERY_S = 0.05


class LobbyFeed:
    """Subscriptions that keep a lobby current, open from their making until `close`."""

    def __init__(self, bus: AsyncBus, lobby: Lobby) -> None:
        self._bus = bus
        self._lobby = lobby
        self._unreadable = 0
        self._log_limit = RateLimit(1)
        self._opened: list[Closable] = [
            bus.watch(keys.EVERY_ALIVE, lobby.see_alive),
            bus.subscribe(keys.EVERY_STATUS, self._reading(self._on_status)),
            bus.subscribe(keys.EVERY_EVENT, self._reading(self._on_event)),
            bus.subscribe(keys.EVERY_STILL, self._reading(self._on_thumbnail)),
        ]

    def close(self) -> None:
        """End the subscriptions."""
        while self._opened:
            self._opened.pop().close()

    async def settled(self) -> None:
        """Wait until every room that is open now has been heard of, so that the first page shows them all.

        A room speaks ten times a second; one that is silent for 2 s is not waited for.
        """
        deadline_s = clock.monotonic_s() + _SETTLE_S
        with self._lobby.listeners.listen() as listener:
            await listener.wait(_SETTLE_S / 10)  # tokens that exist already come one by one
            while self._lobby.rooms.unheard and (left_s := deadline_s - clock.monotonic_s()) > 0:
                await listener.wait(left_s)

    async def keep_asking(self) -> None:
        """Ask who is alive every 2 s, until cancelled: a word of a token that came or went may have been lost."""
        while True:
            await self.ask_who_is_alive()
            await asyncio.sleep(_ASK_EVERY_S)

    async def keep_looking(self) -> None:
        """Notice rooms that have fallen silent, until cancelled."""
        while True:
            self._lobby.see_silence(clock.monotonic_s())
            await asyncio.sleep(_LOOK_EVERY_S)

    async def ask_who_is_alive(self) -> None:
        """Take in the list of all liveliness tokens; a router that does not answer is asked again later."""
        with contextlib.suppress(Unavailable):
            self._lobby.see_every_alive(await self._bus.alive(keys.EVERY_ALIVE))

    def _reading(self, take: Callable[[Sample], None]) -> Handler:
        def read(sample: Sample) -> None:
            try:
                take(sample)
            except Exception as error:  # noqa: BLE001 - logged; the next message must still be read
                self._unreadable += 1
                if self._log_limit.allows(clock.monotonic_s()):
                    trace = None if isinstance(error, MartError) else error
                    _log.warning(
                        "Not used on %s (%d so far): %s", sample.key, self._unreadable, error, exc_info=trace
                    )

        return read

    def _on_status(self, sample: Sample) -> None:
        status = decode_received(RoomStatus, sample.payload, _MAX_MESSAGE_BYTES)
        require_room(status, sample.key)
        self._lobby.see_status(status, clock.monotonic_s())

    def _on_event(self, sample: Sample) -> None:
        event = decode_received(Event, sample.payload, _MAX_MESSAGE_BYTES)
        require_room(event, sample.key)
        self._lobby.see_event(event, clock.monotonic_s(), clock.wall_ns())

    def _on_thumbnail(self, sample: Sample) -> None:
        image = decode_received(CompressedImage, sample.payload, _MAX_THUMBNAIL_BYTES)
        self._lobby.see_thumbnail(sample.key, image.data, clock.monotonic_s())
