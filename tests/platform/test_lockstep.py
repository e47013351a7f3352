"""Asking rooms for episodes; the rooms and the recorder are acted here."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator

import pytest

from mart.platform.lockstep import LockstepSession
from mart.platform.session import Episode
from mart.protocol import codec, keys
from mart.protocol.bus import Bus, Request
from mart.protocol.bus.zenoh_bus import ZenohBus
from mart.protocol.errors import Conflict, Unavailable
from mart.protocol.messages import (
    OUTCOME_SUCCESS,
    EpisodeRequest,
    Event,
    RoomReply,
    RoomStatus,
    error_message,
)
from tests.support.processes import running_router

pytestmark = pytest.mark.system

ROOMS = ("room-1", "room-2")


@pytest.fixture
def bus() -> Iterator[Bus]:
    with running_router() as endpoint, ZenohBus.connect(endpoint) as bus:
        yield bus


class ActedRoom:
    """Answers requests and says that an episode began and ended; saved only when the test says so."""

    def __init__(self, bus: Bus, name: str, arrivals: threading.Semaphore, newest: int = 0) -> None:
        self.name = name
        self._arrivals = arrivals
        self.asked: list[int] = []
        self._events = bus.publisher(keys.in_order(keys.event(name)))
        self._status = bus.publisher(keys.status(name))
        self._newest = newest
        self._closing = threading.Event()
        self._opened = [bus.announce(keys.alive("sim", name)), bus.serve(keys.episode(name), self._answer)]
        self._speaker = threading.Thread(target=self._speak)
        self._speaker.start()

    def save(self, number: int) -> None:
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
        started = Event.EpisodeStarted(number=number, seed=10 * number, control_hz=20.0, skill="average")
        ended = Event.EpisodeEnded(
            number=number, outcome=OUTCOME_SUCCESS, ticks=70, reason="the task is done"
        )
        self._events.put(codec.encode(Event(room=self.name, wall_ns=1, episode_started=started)))
        self._events.put(codec.encode(Event(room=self.name, wall_ns=10**9, episode_ended=ended)))
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


def collect(bus: Bus, rooms: dict[str, ActedRoom], episodes: int) -> list[Episode]:
    """Everything is saved as soon as it has ended."""

    def save(sample_payload: bytes) -> None:
        event = codec.decode(Event, sample_payload)
        if event.HasField("episode_ended"):
            rooms[event.room].save(event.episode_ended.number)

    with (
        contextlib.closing(bus.subscribe(keys.EVERY_EVENT, lambda sample: save(sample.payload))),
        contextlib.closing(LockstepSession(bus, ROOMS, episodes)) as session,
    ):
        return list(session.run())


def test_numbers_are_given_out_once_over_all_rooms_and_go_on(bus: Bus, rooms: dict[str, ActedRoom]) -> None:
    episodes = collect(bus, rooms, 9)
    assert sorted(episode.number for episode in episodes) == list(range(6, 15))
    assert sorted(number for room in rooms.values() for number in room.asked) == list(range(6, 15))
    assert {(e.seed // 10 - e.number, e.skill, e.simulated_s) for e in episodes} == {(0, "average", 3.5)}


def test_no_more_is_asked_for_than_can_be_saved(
    bus: Bus, rooms: dict[str, ActedRoom], arrivals: threading.Semaphore
) -> None:
    with contextlib.closing(LockstepSession(bus, ROOMS, 20)) as session:
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
    with contextlib.closing(LockstepSession(bus, ROOMS, 2)) as session:
        rooms["room-1"].complain("The disk is full.")
        with pytest.raises(Unavailable, match="The disk is full"):
            list(session.run())
