"""Collect episodes in rooms that drive themselves, with a recorder and a replica; nobody watches and nobody waits.

Every room is asked for one episode after another, but only while few are unsaved: recording and verifying set the pace,
so nothing is lost. Numbers are given out over all rooms, and a number decides an episode's seed, so the same episodes
are made by however many rooms there are. An episode counts when its file is there; events only make it quick. What a
room says may be lost on its way to the recorder, as when the router is started anew: in the place of an episode that no
file tells of, another one is asked for.
"""

from __future__ import annotations

import contextlib
import itertools
import queue
import threading
from collections.abc import Iterator, Sequence

from mart.platform.collect.saved_episodes import CollectedEpisode, FindEpisode
from mart.platform.run.room_statuses import statuses_of
from mart.protocol import clock, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import EpisodeRequest, Event, RoomReply
from mart.protocol.received import decode_received
from mart.runtime.ask import ask
from mart.runtime.bus.base import Bus, Sample

_UNSAVED_A_ROOM = 2  # one that is being made, one that is being verified
_PATIENCE_S = 120.0  # a room answers between two episodes
_LOST_AFTER_S = 60.0  # without any file
_LOOK_EVERY_S = 0.5


def _newest_number(bus: Bus, rooms: Sequence[str]) -> int:
    statuses = statuses_of(bus, rooms, _PATIENCE_S)
    silent = sorted(set(rooms) - {status.room for status in statuses})
    if silent:
        raise Unavailable(
            f"{', '.join(silent)} said nothing for {_PATIENCE_S:g} s; see the logs of the rooms."
        )
    return max(status.episode.number for status in statuses)


class UnpacedSession:
    """Make `episodes` in `rooms`. `find` looks for the file of an episode.

    Where none is saved for `lost_after_s`, those that rooms were asked for are replaced, once each.
    """

    def __init__(
        self,
        bus: Bus,
        rooms: Sequence[str],
        episodes: int,
        find: FindEpisode,
        lost_after_s: float = _LOST_AFTER_S,
    ) -> None:
        self._bus, self._episodes, self._find = bus, episodes, find
        self._lost_after_s = lost_after_s
        first = 1 + _newest_number(bus, rooms)
        self._numbers: queue.SimpleQueue[int] = queue.SimpleQueue()
        for number in range(first, first + episodes):
            self._numbers.put(number)
        self._later_numbers = itertools.count(first + episodes)
        self._unsaved = threading.Semaphore(_UNSAVED_A_ROOM * len(rooms))
        self._asked: dict[int, str] = {}  # number → room, of what has no file yet
        self._replaced: set[int] = set()
        self._stopped = threading.Event()
        self._heard: queue.SimpleQueue[Event | MartError] = queue.SimpleQueue()
        self._subscription = bus.subscribe(keys.EVERY_EVENT, self._on_event)
        self._askers = [threading.Thread(target=self._ask_all, args=(room,)) for room in rooms]

    def run(self) -> Iterator[CollectedEpisode]:
        """Yield each episode when its file is saved, not in the order of numbers.

        Raises Unavailable where a room or the recorder gives up, or nothing is saved for two minutes.
        """
        for asker in self._askers:
            asker.start()
        saved, newest_s = 0, clock.monotonic_s()
        while saved < self._episodes:
            self._wait()
            for episode in self._find_all():
                saved, newest_s = saved + 1, clock.monotonic_s()
                self._unsaved.release()
                yield episode
            if clock.monotonic_s() - newest_s > self._lost_after_s:
                self._replace_lost()
            if clock.monotonic_s() - newest_s > _PATIENCE_S:
                raise Unavailable(
                    f"No episode was saved for {_PATIENCE_S:g} s; the services' logs are beside the episodes."
                )

    def close(self) -> None:
        """Wait for the rooms to end what they are at."""
        self._stopped.set()
        for _ in self._askers:
            self._unsaved.release()
        for asker in self._askers:
            if asker.ident is not None:
                asker.join()
        self._subscription.close()

    def _ask_all(self, room: str) -> None:
        try:
            while self._unsaved.acquire() and not self._stopped.is_set():
                with contextlib.suppress(queue.Empty):  # all are given out, unless one is lost
                    number = self._numbers.get_nowait()
                    self._ask(room, number)
                    self._asked[number] = room
        except MartError as error:
            self._heard.put(error)

    def _replace_lost(self) -> None:
        for number in self._asked.copy().keys() - self._replaced:
            self._replaced.add(number)
            self._numbers.put(next(self._later_numbers))
            self._unsaved.release()

    def _ask(self, room: str, number: int) -> None:
        ready = EpisodeRequest.Ready(arm="arm0", ready=True, number=number)
        ask(self._bus, keys.episode(room), EpisodeRequest(ready=ready), RoomReply, _PATIENCE_S)

    def _find_all(self) -> Iterator[CollectedEpisode]:
        for number, room in sorted(self._asked.copy().items()):
            episode = self._find(room, number)
            if episode is not None:
                del self._asked[number]
                yield episode

    def _on_event(self, sample: Sample) -> None:
        try:
            self._heard.put(decode_received(Event, sample.payload))
        except MartError as error:
            self._heard.put(error)

    def _wait(self) -> None:
        """Until something was saved, or it is time to look; raises what an asker or a service complained of."""
        until_s = clock.monotonic_s() + _LOOK_EVERY_S
        while (left_s := until_s - clock.monotonic_s()) > 0:
            try:
                heard = self._heard.get(timeout=left_s)
            except queue.Empty:
                return
            if isinstance(heard, MartError):
                raise heard
            if heard.notice.level == "error":
                raise Unavailable(heard.notice.text)
            if heard.HasField("episode_saved"):
                return
