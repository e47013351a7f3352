"""Hear of a room's saved episodes, each once: from the recorder's event or, where that is lost, from the catalogue."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections import Counter
from collections.abc import Callable, Iterable

from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput, MartError
from mart.protocol.messages import CatalogueReply, CatalogueRequest, Event, RoomStatus, is_good
from mart.protocol.received import decode_received
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.ask import ask
from mart.runtime.awaited_saves import AwaitedSaves, saved_event
from mart.runtime.bus import Bus, Sample

_log = logging.getLogger(__name__)

_MAX_EVENT_BYTES = 64 * 1024
_LOOK_EVERY_S = 1.0
_ASK_TIMEOUT_S = 5.0
_LISTED = 64
_REMEMBERED = 256

OnSaved = Callable[[Event.EpisodeSaved], None]


class SaveFollower:
    """Call `on_saved` for each episode of a room whose file is there, once, or again when it has become good.

    garbled: counts what could not be decoded. awaited: episodes that ended before, of whose file nobody has heard.
    Asks on a thread of its own.
    """

    def __init__(
        self,
        bus: Bus,
        room: str,
        on_saved: OnSaved,
        garbled: Counter[str],
        awaited: Iterable[int] = (),
    ) -> None:
        self._bus, self._room, self._on_saved, self._garbled = bus, room, on_saved, garbled
        self._awaited = AwaitedSaves()
        for number in awaited:
            self._awaited.await_saved(room, number, clock.monotonic_s())
        self._heard: dict[int, bool] = {}  # number → whether it is good
        self._lock = threading.Lock()
        self._closing = threading.Event()
        self._subscriptions = [
            bus.subscribe(keys.event(room).key, self._on_event),
            bus.subscribe(keys.status(room).key, self._on_status),
        ]
        self._asker = threading.Thread(target=self._ask_all, name="saves", daemon=True)
        self._asker.start()

    def close(self) -> None:
        """Stop listening and asking."""
        self._closing.set()
        for subscription in self._subscriptions:
            subscription.close()
        self._asker.join(_ASK_TIMEOUT_S)

    def _on_event(self, sample: Sample) -> None:
        try:
            event = decode_received(Event, sample.payload, _MAX_EVENT_BYTES)
        except InvalidInput:
            self._garbled["event"] += 1
            return
        if event.HasField("episode_saved"):
            self._hear(event.episode_saved)

    def _on_status(self, sample: Sample) -> None:
        with contextlib.suppress(InvalidInput):  # the room's own words, or somebody's garbage
            status = decode_received(RoomStatus, sample.payload, _MAX_EVENT_BYTES)
            with self._lock:
                self._awaited.see_status(status, clock.monotonic_s())

    def _hear(self, saved: Event.EpisodeSaved) -> None:
        with self._lock:
            self._awaited.see_saved(self._room, saved.number)
            good = is_good(saved)
            if self._heard.get(saved.number, False) or self._heard.get(saved.number) is good:
                return  # an episode in two files, or told of twice
            self._heard[saved.number] = good
            while len(self._heard) > _REMEMBERED:
                del self._heard[next(iter(self._heard))]
        self._on_saved(saved)

    def _ask_all(self) -> None:
        while not self._closing.wait(_LOOK_EVERY_S):
            try:
                self._ask()
            except MartError as error:
                _log.info("Whether episodes are saved is not known yet: %s", error)
            except Exception:  # noqa: BLE001 - logged whole; the next look may find what this one did not
                _log.exception("Whether episodes are saved could not be asked")

    def _ask(self) -> None:
        with self._lock:
            due = self._awaited.take_due(clock.monotonic_s())
        if not due:
            return
        request = CatalogueRequest(list=CatalogueRequest.List(room=self._room, count=_LISTED))
        for key in self._bus.alive(keys.alive_of(ServiceKind.CATALOGUE))[:1]:
            reply = ask(
                self._bus, keys.catalogue(keys.last_of(key)), request, CatalogueReply, _ASK_TIMEOUT_S,
                limit_bytes=codec.MAX_MESSAGE_BYTES,
            )  # fmt: skip
            for save in due:
                event = saved_event(save, reply.listing.episodes)
                if event is not None:
                    self._hear(event.episode_saved)
