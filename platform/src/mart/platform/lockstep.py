"""Episodes in lockstep: rooms that drive themselves, a recorder and a replica; nobody watches and nobody waits.

Every room is asked for one episode after another, but only while few are unsaved: recording and verifying set the pace,
so nothing is lost. Numbers are given out over all rooms, and a number decides an episode's seed, so the same episodes
are made by however many rooms there are.
"""

from __future__ import annotations

import queue
import threading
from collections import defaultdict
from collections.abc import Iterator, Sequence

from mart.platform.rooms import open_rooms
from mart.platform.session import Episode, episode_of
from mart.protocol import codec, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import EpisodeRequest, Event, RoomReply, raise_error
from mart.runtime.bus.base import Bus, Sample

_UNSAVED_A_ROOM = 2  # one that is being made, one that is being verified
_OF_AN_EPISODE = {"episode_started", "episode_ended", "episode_saved"}
_PATIENCE_S = 120.0  # a room answers between two episodes


class LockstepSession:
    """Makes `episodes` in `rooms`."""

    def __init__(self, bus: Bus, rooms: Sequence[str], episodes: int) -> None:
        self._bus, self._episodes = bus, episodes
        first = 1 + max((status.episode.number for status in open_rooms(bus)), default=0)
        self._numbers = iter(range(first, first + episodes))
        self._unsaved = threading.Semaphore(_UNSAVED_A_ROOM * len(rooms))
        self._stopped = threading.Event()
        self._heard: queue.SimpleQueue[Event | MartError] = queue.SimpleQueue()
        self._subscription = bus.subscribe(keys.EVERY_EVENT, self._on_event)
        self._askers = [threading.Thread(target=self._ask_all, args=(room,)) for room in rooms]

    def run(self) -> Iterator[Episode]:
        """Each episode when its file is saved, not in the order of numbers.

        Raises Unavailable where a room or the recorder gives up, or nothing is heard for two minutes.
        """
        for asker in self._askers:
            asker.start()
        told: dict[tuple[str, int], dict[str, Event]] = defaultdict(dict)
        saved = 0
        while saved < self._episodes:
            event = self._next()
            what = event.WhichOneof("what") or ""
            if what not in _OF_AN_EPISODE:
                continue
            key = (event.room, getattr(event, what).number)
            told[key][what] = event
            if (
                told[key].keys() == _OF_AN_EPISODE
            ):  # what an earlier run left is saved as well, but begins nowhere
                saved += 1
                self._unsaved.release()
                events = told.pop(key)
                yield episode_of(
                    events["episode_started"], events["episode_ended"], events["episode_saved"].episode_saved
                )

    def close(self) -> None:
        """Waits for the rooms to end what they are at."""
        self._stopped.set()
        for _ in self._askers:
            self._unsaved.release()
        for asker in self._askers:
            if asker.ident is not None:
                asker.join()
        self._subscription.close()

    def _ask_all(self, room: str) -> None:
        try:
            while not self._stopped.is_set() and (number := next(self._numbers, None)) is not None:
                self._unsaved.acquire()
                if not self._stopped.is_set():
                    self._ask(room, number)
        except MartError as error:
            self._heard.put(error)

    def _ask(self, room: str, number: int) -> None:
        ready = EpisodeRequest.Ready(arm="arm0", ready=True, number=number)
        payload = codec.encode(EpisodeRequest(ready=ready))
        reply = self._bus.query(keys.episode(room), payload, _PATIENCE_S)
        raise_error(codec.decode(RoomReply, reply).error)

    def _on_event(self, sample: Sample) -> None:
        try:
            self._heard.put(codec.decode(Event, sample.payload))
        except MartError as error:
            self._heard.put(error)

    def _next(self) -> Event:
        """Raises what an asker or a service complained of."""
        try:
            heard = self._heard.get(timeout=_PATIENCE_S)
        except queue.Empty:
            raise Unavailable(
                f"No episode was saved for {_PATIENCE_S:g} s; the services' logs are beside the episodes."
            ) from None
        if isinstance(heard, MartError):
            raise heard
        if heard.notice.level == "error":
            raise Unavailable(heard.notice.text)
        return heard
