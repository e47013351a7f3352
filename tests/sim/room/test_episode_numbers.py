"""Rooms that share a seed give out numbers among themselves."""

from __future__ import annotations

import pytest

from mart.protocol.errors import Conflict
from mart.protocol.messages import OPERATOR_SCRIPT, EpisodeRequest
from mart.sim.room.episode_state_machine import (
    COUNTDOWN_S,
    ENDED_S,
    BeginEpisode,
    EpisodeStateMachine,
    seed_of,
)
from mart.sim.room.seats import SeatTable


@pytest.fixture
def seats() -> SeatTable:
    seats = SeatTable(["arm0"])
    seats.assign("arm0", OPERATOR_SCRIPT)
    return seats


def play(episode: EpisodeStateMachine, seats: SeatTable, number: int = 0) -> BeginEpisode:
    """One episode, back to practice; how it started."""
    ready = EpisodeRequest(ready=EpisodeRequest.Ready(arm="arm0", ready=True, number=number))
    episode.answer(ready, seats, 0.0)
    (started,) = episode.advance(True, COUNTDOWN_S)
    assert isinstance(started, BeginEpisode)
    episode.ticked(True, None, 10.0)
    episode.advance(True, 10.0 + ENDED_S)
    return started


def test_the_number_decides_the_seed_in_whichever_room(seats: SeatTable) -> None:
    one, other = EpisodeStateMachine(7, horizon_ticks=5), EpisodeStateMachine(7, horizon_ticks=5)
    play(one, seats, 1)
    play(one, seats, 2)
    play(other, seats, 1)
    assert play(one, seats, 9) == play(other, seats, 9) == BeginEpisode(9, seed_of(7, "episode", 9))


def test_without_a_number_the_next_one_follows(seats: SeatTable) -> None:
    episode = EpisodeStateMachine(7, horizon_ticks=5)
    play(episode, seats, 4)
    assert play(episode, seats).number == 5


def test_no_number_comes_twice(seats: SeatTable) -> None:
    episode = EpisodeStateMachine(7, horizon_ticks=5)
    play(episode, seats, 4)
    for number in (1, 4):
        with pytest.raises(Conflict):
            play(episode, seats, number)
