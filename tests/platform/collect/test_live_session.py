"""A session's view of one episode: the room's status and the file count, events only lend what files do not hold."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import cast

import pytest

from mart.platform.collect.emulated_users import EmulatedUser
from mart.platform.collect.live_session import LiveSession
from mart.platform.collect.saved_episodes import CollectedEpisode
from mart.platform.collect.web_client import WebClient
from mart.protocol import keys
from mart.protocol import messages as m
from mart.protocol.codec import encode
from mart.protocol.errors import Conflict, Unavailable
from mart.protocol.vocabulary import EpisodeOutcome, Verdict
from mart.runtime.bus.memory import MemoryNetwork

EPISODE = CollectedEpisode(
    number=4,
    seed=5,
    skill="expert",
    path="episodes/a.mcap",
    outcome=EpisodeOutcome.SUCCESS,
    reason="the task is done",
    ticks=78,
    simulated_s=3.9,
    real_time_factor=0.99,
    verdict=Verdict.VERIFIED,
    latencies=(m.Event.Latency(arm="arm0", p50_ms=30.0, p95_ms=41.0),),
)


class Acted:
    """A room that says what it is told to, until the session has ended."""

    def __init__(self) -> None:
        self.network = MemoryNetwork()
        self.files: dict[int, CollectedEpisode] = {}
        self.was_found = threading.Event()
        self.bus = self.network.connect()
        self._status = self.bus.publisher(keys.status("room-1"))
        self._events = self.bus.publisher(keys.event("room-1"))

    def say(self, phase: m.EpisodePhase, number: int, ticks: int = 0, seats: Sequence[m.Seat] = ()) -> None:
        episode = m.Episode(phase=phase, number=number, ticks=ticks)
        self._status.put(encode(m.RoomStatus(room="room-1", episode=episode, seats=seats)))

    def tell(self, event: m.Event) -> None:
        self._events.put(encode(event))

    def find(self, _room: str, number: int) -> CollectedEpisode | None:
        found = self.files.get(number)
        if found is not None:
            self.was_found.set()
        return found

    @contextlib.contextmanager
    def session(self) -> Iterator[LiveSession]:
        bus = self.network.connect()
        with contextlib.closing(LiveSession(bus, "room-1", self.find)) as session:
            yield session


class Ready:
    """A person's way to say ready, after which the acts follow on a thread of their own."""

    def __init__(self, acts: Sequence[Callable[[], object]]) -> None:
        self._actor = threading.Thread(target=lambda: [act() for act in acts])

    def act(self, _room: str, _arm: str, _what: str) -> None:
        self._actor.start()

    def join(self) -> None:
        self._actor.join()


def play(acted: Acted, session: LiveSession, acts: Sequence[Callable[[], object]]) -> CollectedEpisode:
    """Runs an episode; the acts begin when everyone is ready."""
    ready = Ready(acts)
    acted.say(m.EPISODE_PHASE_PRACTICE, 3)
    try:
        return session.run_episode([EmulatedUser("arm0", "Ana", cast("WebClient", ready))])
    finally:
        ready.join()


def test_an_episode_counts_when_its_file_is_there_though_nobody_said_a_word() -> None:
    acted = Acted()
    with acted.session() as session:
        episode = play(
            acted,
            session,
            [lambda: acted.files.update({4: EPISODE}), lambda: acted.say(m.EPISODE_PHASE_PRACTICE, 4)],
        )
    assert episode == EPISODE


def test_a_file_that_does_not_know_the_outcome_waits_for_another_that_does() -> None:
    acted = Acted()
    with acted.session() as session:
        episode = play(
            acted,
            session,
            [
                lambda: acted.files.update({4: replace(EPISODE, outcome=EpisodeOutcome.UNSPECIFIED)}),
                lambda: acted.say(m.EPISODE_PHASE_PRACTICE, 4),
                lambda: acted.was_found.wait(30.0),
                lambda: acted.files.update({4: EPISODE}),
            ],
        )
    assert episode == EPISODE


def test_the_stages_of_the_seats_delays_come_from_their_reports() -> None:
    acted = Acted()
    stage = m.Event.Latency.Stage(name="render", p50_ms=9.0)
    report = m.Event.Latency(arm="arm1", p50_ms=35.0, p95_ms=60.0, frames=9, stages=[stage])
    with acted.session() as session:
        episode = play(
            acted,
            session,
            [
                lambda: acted.say(m.EPISODE_PHASE_RECORDING, 4, ticks=1),
                lambda: acted.tell(m.Event(latency=report)),
                lambda: acted.files.update({4: EPISODE}),
                lambda: acted.say(m.EPISODE_PHASE_PRACTICE, 4),
            ],
        )
    line = episode.as_json()
    assert line["motion_to_photon_p95_ms"] == 60.0  # the worst seat's
    assert list(line["motion_to_photon"]) == ["arm0", "arm1"]
    assert line["motion_to_photon"]["arm1"]["stages_p50_ms"] == {"render": 9.0}
    assert (line["outcome"], line["verified"], line["real_time_factor"]) == ("success", True, 0.99)


def test_readiness_that_a_room_has_forgotten_is_said_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.platform.collect.live_session._READY_AGAIN_S", 0.01)
    acted = Acted()

    class Person:
        """The room forgets what is said first, and has gone on when it is said again."""

        said = 0

        def act(self, _room: str, _arm: str, _what: str) -> None:
            self.said += 1
            if self.said == 1:
                acted.say(m.EPISODE_PHASE_PRACTICE, 3, seats=[m.Seat(arm="arm0"), m.Seat(arm="arm1")])
            else:
                acted.files[4] = EPISODE
                acted.say(m.EPISODE_PHASE_PRACTICE, 4, seats=[m.Seat(arm="arm0")])
                raise Conflict("It counts in practice only.")

    with acted.session() as session:
        acted.say(m.EPISODE_PHASE_PRACTICE, 3)
        person = Person()
        ana = EmulatedUser("arm0", "Ana", cast("WebClient", person))
        assert session.run_episode([ana]) == EPISODE
        assert person.said == 2


def test_without_a_page_there_is_no_motion_to_photon() -> None:
    line = replace(EPISODE, latencies=()).as_json()
    assert (line["motion_to_photon_p50_ms"], line["motion_to_photon_p95_ms"]) == (None, None)
    assert line["motion_to_photon"] == {}


def test_a_room_that_does_not_start_is_an_error_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.platform.collect.live_session._STILL_S", 0.01)
    acted = Acted()
    with acted.session() as session, pytest.raises(Unavailable):
        play(acted, session, [])


def test_an_episode_that_is_not_saved_is_an_error_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.platform.collect.live_session._SAVE_TIMEOUT_S", 0.01)
    acted = Acted()
    acts = [
        lambda: acted.say(m.EPISODE_PHASE_RECORDING, 4, ticks=1),
        lambda: acted.say(m.EPISODE_PHASE_ENDED, 4),
    ]
    with acted.session() as session, pytest.raises(Unavailable):
        play(acted, session, acts)
