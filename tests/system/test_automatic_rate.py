"""A room whose rate nobody gave: it chooses one, keeps it through an episode, and may have another after it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, keys
from mart.protocol.control_rate import OFFERED_CONTROL_HZ
from mart.protocol.messages import (
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OUTCOME_FAILURE,
    EpisodeRequest,
    Event,
    RoomStatus,
    raise_error,
)
from mart.sim.room import saved_room
from mart.sim.room.saved_room import SavedRoom
from tests.support.processes import running_router, running_service
from tests.system.room_client import Driver, RoomClient

ROOM = "room-1"
TICKS = 60
_PATIENCE_S = 60.0


@pytest.fixture
def client(tmp_path: Path) -> Iterator[RoomClient]:
    """Who asks a room in which pictures took next to nothing the last time, with its recorder and replica."""
    saved_room.save(tmp_path / "rooms" / f"{ROOM}.json", SavedRoom(seed=1, picture_s=1e-4))
    with ExitStack() as running:
        endpoint = running.enter_context(running_router())
        for command, kind, name in (
            (["replica"], "replica", "replica-1"),
            (["recorder"], "recorder", "recorder-1"),
            (["sim", "--room", ROOM], "sim", ROOM),
        ):
            running.enter_context(running_service(command, endpoint, tmp_path, kind=kind, id=name))
        yield running.enter_context(RoomClient(endpoint, ROOM))


def picture_costs(client: RoomClient, picture_ms: float) -> None:
    """Says for both seats, as their gateway would, what a picture takes."""
    publisher = client.bus.publisher(keys.event(ROOM))
    for arm in ("arm0", "arm1"):
        cost = Event.PictureCost(arm=arm, picture_ms=picture_ms)
        publisher.put(codec.encode(Event(room=ROOM, picture_cost=cost)))


def record(client: RoomClient, drivers: list[Driver]) -> RoomStatus:
    """Into an episode; its first status."""
    for driver in drivers:
        ready = EpisodeRequest.Ready(arm=driver.arm, holder_id=driver.arm, ready=True)
        raise_error(client.episode(EpisodeRequest(ready=ready)).error)
    while True:  # a countdown waits for those who give no command
        for driver in drivers:
            driver.give()
        status = client.statuses.wait_next()
        if status.episode.phase == EPISODE_PHASE_RECORDING:
            return status


def drive(client: RoomClient, drivers: list[Driver]) -> None:
    """Through an episode, which then is said to have failed."""
    for _ in range(TICKS):
        client.tick(*drivers)
    finish = EpisodeRequest.Finish(holder_id=drivers[0].arm, outcome=OUTCOME_FAILURE)
    raise_error(client.episode(EpisodeRequest(finish=finish)).error)


def require_one_rate(client: RoomClient, data_dir: Path, number: int, begun: RoomStatus) -> None:
    """The file of an episode is verified, and of the rate and the run of the room at which it began."""
    saved = client.events.wait_for(lambda event: event.episode_saved.number == number, _PATIENCE_S)
    assert saved.episode_saved.verified, saved.episode_saved.verdict
    file = EpisodeFile.open(data_dir / saved.episode_saved.path)
    states = list(file.states())
    assert file.episode.control_hz == file.room.control_hz == begun.control_hz
    assert len(states) == file.episode.ticks + 1 > TICKS
    assert {state.boot for state in states} == {begun.boot}
    assert np.allclose(np.diff([state.sim_time_s for state in states]), 1 / begun.control_hz)


def test_a_rate_that_is_not_held_falls_after_the_episode_and_never_in_it(
    client: RoomClient, tmp_path: Path
) -> None:
    drivers = [client.driver(client.claim(arm, arm).seat) for arm in ("arm0", "arm1")]
    begun = record(client, drivers)
    assert begun.control_hz in OFFERED_CONTROL_HZ[1:]
    picture_costs(client, picture_ms=200.0)
    drive(client, drivers)

    after = client.statuses.wait_for(lambda status: status.control_hz < begun.control_hz)
    assert after.episode.phase == EPISODE_PHASE_PRACTICE
    assert [seat.epoch for seat in after.seats] == [seat.epoch for seat in begun.seats]
    notice = client.events.wait_for(lambda event: "times a second" in event.notice.text).notice
    assert notice.text.startswith(f"The room now ticks {after.control_hz:g} times a second: ")
    assert "200 ms" in notice.text
    state = client.tick(*drivers)
    assert client.model().control_hz == after.control_hz
    assert state.boot == after.boot != begun.boot

    begun_again = record(client, drivers)
    drive(client, drivers)
    require_one_rate(client, tmp_path, 1, begun)
    require_one_rate(client, tmp_path, 2, begun_again)
