"""Asking rooms for episodes; the rooms and the recorder are acted here."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from collections.abc import Set as AbstractSet

import pytest

from mart.platform.collect.saved_episodes import CollectedEpisode
from mart.platform.collect.unpaced_session import UnpacedSession
from mart.protocol import codec, keys
from mart.protocol.errors import Conflict, Unavailable
from mart.protocol.messages import (
    EpisodeRequest,
    Event,
    RoomReply,
    RoomStatus,
    error_message,
)
from mart.protocol.vocabulary import EpisodeOutcome, ServiceKind, Verdict
from mart.runtime.bus import Bus, Request
from mart.runtime.bus.zenoh_bus import ZenohBus
from tests.support.processes import running_router

pytestmark = pytest.mark.system

ROOMS = ("room-1", "room-2")


@pytest.fixture
def bus() -> Iterator[Bus]:
    with running_router() as endpoint, ZenohBus.connect(endpoint) as bus:
        yield bus


class ActedRoom:
    """Answers requests; an episode is saved only when the test says so, and told of or not."""

    def __init__(self, bus: Bus, name: str, arrivals: threading.Semaphore, newest: int = 0) -> None:
        self.name = name
        self._arrivals = arrivals
        self.asked: list[int] = []
        self.files: dict[int, CollectedEpisode] = {}
        self._events = bus.publisher(keys.in_order(keys.event(name)))
        self._status = bus.publisher(keys.status(name))
        self._newest = newest
        self._closing = threading.Event()
        self._opened = [
            bus.announce(keys.alive(ServiceKind.SIM, name)),
            bus.serve(keys.episode(name), self._answer),
        ]
        self._speaker = threading.Thread(target=self._speak)
        self._speaker.start()

    def save(self, number: int, *, told: bool = True) -> None:
        self.files[number] = CollectedEpisode(
            number=number,
            seed=10 * number,
            skill="average",
            path=f"episodes/{self.name}-{number}.mcap",
            outcome=EpisodeOutcome.SUCCESS,
            reason="the task is done",
            ticks=70,
            simulated_s=3.5,
            real_time_factor=9.0,
            verdict=Verdict.VERIFIED,
        )
        if told:
            saved = Event.EpisodeSaved(number=number, path=f"{self.name}-{number}.mcap", verified=True)
            self._events.put(codec.encode(Event(room=self.name, episode_saved=saved)))

    def complain(self, text: str) -> None:
        event = Event(room=self.name)
        event.notice.level, event.notice.text = "error", text
        self._events.put(codec.encode(event))

    def close(self) -> None:
        self._closing.set()
        self._speaker.join()
        for opened in self._opened:
            opened.close()

    def _speak(self) -> None:
        status = RoomStatus(room=self.name)
        status.episode.number = self._newest
        while not self._closing.wait(0.05):
            self._status.put(codec.encode(status))

    def _answer(self, request: Request) -> None:
        number = codec.decode(EpisodeRequest, request.payload).ready.number
        if number <= self._newest:
            request.reply(codec.encode(RoomReply(error=error_message(Conflict("Too low a number.")))))
            return
        self.asked.append(number)
        request.reply(codec.encode(RoomReply()))
        self._arrivals.release()


@pytest.fixture
def arrivals() -> threading.Semaphore:
    """One permit for each request that a room has answered."""
    return threading.Semaphore(0)


@pytest.fixture
def rooms(bus: Bus, arrivals: threading.Semaphore) -> Iterator[dict[str, ActedRoom]]:
    with contextlib.ExitStack() as stack:
        yield {
            name: stack.enter_context(contextlib.closing(ActedRoom(bus, name, arrivals, newest=5)))
            for name in ROOMS
        }


def session_of(bus: Bus, rooms: dict[str, ActedRoom], episodes: int, **more: float) -> UnpacedSession:
    return UnpacedSession(bus, ROOMS, episodes, lambda room, number: rooms[room].files.get(number), **more)


def collect(
    bus: Bus,
    rooms: dict[str, ActedRoom],
    arrivals: threading.Semaphore,
    episodes: int,
    *,
    told: bool,
    lost: AbstractSet[int] = frozenset(),
    **more: float,
) -> list[CollectedEpisode]:
    """Everything that was asked for is saved at once, except what is lost."""
    done = threading.Event()

    def save() -> None:
        while not done.is_set():
            if arrivals.acquire(timeout=0.1):
                for room in rooms.values():
                    for number in set(room.asked) - room.files.keys() - lost:
                        room.save(number, told=told)

    saver = threading.Thread(target=save)
    saver.start()
    with contextlib.closing(session_of(bus, rooms, episodes, **more)) as session:
        found = list(session.run())
    done.set()
    saver.join()
    return found


@pytest.mark.parametrize("told", [True, False])
def test_numbers_are_given_out_once_over_all_rooms_and_files_count_whether_they_are_told_of_or_not(
    bus: Bus, rooms: dict[str, ActedRoom], arrivals: threading.Semaphore, told: bool
) -> None:
    episodes = collect(bus, rooms, arrivals, 9, told=told)
    assert sorted(episode.number for episode in episodes) == list(range(6, 15))
    assert sorted(number for room in rooms.values() for number in room.asked) == list(range(6, 15))


def test_an_episode_that_never_reached_the_recorder_is_replaced_by_another(
    bus: Bus, rooms: dict[str, ActedRoom], arrivals: threading.Semaphore
) -> None:
    episodes = collect(bus, rooms, arrivals, 6, told=True, lost={6, 11}, lost_after_s=1.0)
    numbers = sorted(episode.number for episode in episodes)
    assert len(numbers) == len(set(numbers)) == 6
    assert set(range(7, 11)) < set(numbers)
    assert max(numbers) > 11


def test_no_more_is_asked_for_than_can_be_saved(
    bus: Bus, rooms: dict[str, ActedRoom], arrivals: threading.Semaphore
) -> None:
    with contextlib.closing(session_of(bus, rooms, 20)) as session:
        episodes = session.run()
        first = threading.Thread(target=lambda: next(episodes))
        first.start()
        assert all(arrivals.acquire(timeout=30.0) for _ in range(4))
        assert not arrivals.acquire(timeout=0.3)
        room = next(room for room in rooms.values() if room.asked)
        room.save(room.asked[0])
        first.join(10.0)
        assert not first.is_alive()
        assert arrivals.acquire(timeout=30.0)


def test_what_the_recorder_complains_of_ends_the_session(bus: Bus, rooms: dict[str, ActedRoom]) -> None:
    with contextlib.closing(session_of(bus, rooms, 2)) as session:
        rooms["room-1"].complain("The disk is full.")
        with pytest.raises(Unavailable):
            list(session.run())
