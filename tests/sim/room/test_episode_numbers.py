"""Rooms that share a seed give out numbers among themselves."""

from __future__ import annotations

import pytest

from mart.protocol.errors import Conflict
from mart.protocol.messages import OPERATOR_SCRIPT, EpisodeRequest
from mart.sim.room.episode_state_machine import COUNTDOWN_S, ENDED_S, EpisodeCourse, Started, seed_of
from mart.sim.room.seats import SeatTable


@pytest.fixture
def seats() -> SeatTable:
    seats = SeatTable(["arm0"])
    seats.assign("arm0", OPERATOR_SCRIPT)
    return seats


def play(course: EpisodeCourse, seats: SeatTable, number: int = 0) -> Started:
    """One episode, back to practice; how it started."""
    ready = EpisodeRequest(ready=EpisodeRequest.Ready(arm="arm0", ready=True, number=number))
    course.answer(ready, seats, 0.0)
    (started,) = course.advance(True, COUNTDOWN_S)
    assert isinstance(started, Started)
    course.ticked(True, None, 10.0)
    course.advance(True, 10.0 + ENDED_S)
    return started


def test_the_number_decides_the_seed_in_whichever_room(seats: SeatTable) -> None:
    one, other = EpisodeCourse(7, horizon_ticks=5), EpisodeCourse(7, horizon_ticks=5)
    play(one, seats, 1)
    play(one, seats, 2)
    play(other, seats, 1)
    assert play(one, seats, 9) == play(other, seats, 9) == Started(9, seed_of(7, "episode", 9))


def test_without_a_number_the_next_one_follows(seats: SeatTable) -> None:
    course = EpisodeCourse(7, horizon_ticks=5)
    play(course, seats, 4)
    assert play(course, seats).number == 5


def test_no_number_comes_twice(seats: SeatTable) -> None:
    course = EpisodeCourse(7, horizon_ticks=5)
    play(course, seats, 4)
    for number in (1, 4):
        with pytest.raises(Conflict, match="give a later one or none"):
            play(course, seats, number)
