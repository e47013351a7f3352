"""A session's view of one episode, from the events alone."""

from __future__ import annotations

import pytest

from mart.platform.session import Episode, Session
from mart.protocol import keys
from mart.protocol import messages as m
from mart.protocol.codec import encode
from mart.protocol.errors import Unavailable
from mart.runtime.bus.memory import MemoryNetwork

_SECOND_NS = 1_000_000_000


def latency(arm: str, p95_ms: float) -> m.Event.Latency:
    return m.Event.Latency(arm=arm, p50_ms=p95_ms / 2, p95_ms=p95_ms, frames=9)


def run(events: list[m.Event]) -> Episode:
    network = MemoryNetwork()
    session = Session(network.connect(), "room-1")
    practising = m.RoomStatus(room="room-1", episode=m.Episode(phase=m.EPISODE_PHASE_PRACTICE))
    network.connect().publisher(keys.status("room-1")).put(encode(practising))
    publisher = network.connect().publisher(keys.event("room-1"))
    for event in events:
        publisher.put(encode(event))
    return session.run_episode([])


def test_an_episode_is_what_its_events_say() -> None:
    episode = run(
        [
            m.Event(wall_ns=1, episode_started=m.Event.EpisodeStarted(number=1, control_hz=20.0)),
            m.Event(latency=latency("arm1", 60.0)),
            m.Event(latency=latency("arm0", 40.0)),
            m.Event(
                wall_ns=1 + 4 * _SECOND_NS,
                episode_ended=m.Event.EpisodeEnded(number=1, outcome=m.OUTCOME_SUCCESS, ticks=78),
            ),
            m.Event(episode_saved=m.Event.EpisodeSaved(number=1, path="episodes/a.mcap", verified=True)),
        ]
    )
    line = episode.as_json()
    assert line["path"] == "episodes/a.mcap"
    assert line["outcome"] == "success"
    assert line["real_time_factor"] == pytest.approx(77 / 20 / 4)
    assert line["motion_to_photon_p95_ms"] == 60.0  # the worst seat's
    assert list(line["motion_to_photon"]) == ["arm0", "arm1"]
    assert line["verified"] is True


def test_without_a_page_there_is_no_motion_to_photon() -> None:
    episode = Episode(1, 5, "", "a", "success", "done", 10, 0.5, 1.0, True, "", ())
    assert episode.as_json()["motion_to_photon_p50_ms"] is None


def test_a_room_that_does_not_start_is_an_error_with_a_hint(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mart.platform.session._EPISODE_TIMEOUT_S", 0.01)
    with pytest.raises(Unavailable, match="no episode started"):
        run([])
