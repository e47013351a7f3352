"""The score of stations that are done one after another."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.sim.tasks.stations import HOLD_S, StationScores, memory_size

_TICK_S = 0.05
_IN_ORDER = [[], [0], [1]]


class _Course:
    """Three stations, one after another, in one world."""

    def __init__(self, worlds: tuple[int, ...] = ()) -> None:
        self.memory = np.zeros((*worlds, memory_size(3)))
        self.scores = StationScores(self.memory, _IN_ORDER)
        self.time_s = 0.0

    def tick(self, begun: list[bool], fulfilled: list[bool]) -> None:
        self.time_s += _TICK_S
        flags = np.array(begun)
        self.scores.see(self.time_s, flags, ~flags, np.array(fulfilled))


def test_a_station_is_done_once_its_condition_has_held() -> None:
    course = _Course()
    for _ in range(round(HOLD_S / _TICK_S)):
        course.tick([True, False, False], [True, True, False])
        assert not course.scores.done.any()
    course.tick([True, False, False], [True, True, False])
    assert course.scores.done.tolist() == [True, False, False]
    assert course.scores.seconds[0] == pytest.approx(HOLD_S + _TICK_S)
    assert course.scores.current.tolist() == [False, True, False]


def test_a_condition_that_breaks_off_begins_anew() -> None:
    course = _Course()
    for _ in range(40):
        course.tick([True, False, False], [True, False, False])
        course.tick([True, False, False], [False, False, False])
    assert not course.scores.done.any()


def test_every_beginning_is_a_try() -> None:
    course = _Course()
    for begun in (False, True, True, False, True, False):
        course.tick([begun, begun, False], [False, False, False])
    assert course.scores.tries.tolist() == [2.0, 0.0, 0.0]


_FLAGS = st.lists(
    st.tuples(
        st.lists(st.booleans(), min_size=3, max_size=3), st.lists(st.booleans(), min_size=3, max_size=3)
    ),
    max_size=80,
)


@given(_FLAGS, _FLAGS)
def test_worlds_of_a_batch_are_scored_as_alone_in_order_and_for_good(
    first: list[tuple[list[bool], list[bool]]], second: list[tuple[list[bool], list[bool]]]
) -> None:
    ticks = [pair for pair in zip(first, second, strict=False) for _ in range(4)]
    alone, batch = [_Course(), _Course()], _Course((2,))
    for number, pair in enumerate(ticks, start=1):
        before = batch.scores.done
        for course, flags in zip(alone, pair, strict=True):
            course.tick(*flags)
        begun, fulfilled = (np.array([one[which] for one in pair]) for which in (0, 1))
        batch.scores.see(np.full(2, alone[0].time_s), begun, ~begun, fulfilled)
        done = batch.scores.done
        assert (done | ~before).all()
        assert (done[:, :-1] | ~done[:, 1:]).all()
        assert batch.scores.seconds.sum(axis=-1).max() <= number * _TICK_S + 1e-9
        for world, course in enumerate(alone):
            assert batch.memory[world].tobytes() == course.memory.tobytes()
