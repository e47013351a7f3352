"""A picture stands still where the world goes on and nothing newer is displayed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.teleop_gateway.input.picture_watch import STILL_AFTER_S, PictureWatch

TICK_S = 0.05


@pytest.fixture
def watch() -> PictureWatch:
    watch = PictureWatch()
    watch.page_came()
    return watch


def test_a_picture_that_comes_late_moves_all_the_same(watch: PictureWatch) -> None:
    """What is displayed is 2 s old, and goes on."""
    for tick in range(1, 100):
        now_s = tick * TICK_S
        watch.on_state(tick, now_s)
        if tick > 40:
            watch.on_displayed(tick - 40, now_s)
            assert not watch.stands_still(now_s)


def test_a_world_that_rests_has_no_news(watch: PictureWatch) -> None:
    watch.on_state(5, 0.0)
    watch.on_displayed(5, 0.1)
    watch.on_state(5, 60.0)
    assert not watch.stands_still(60.0)


def test_what_was_displayed_last_counts_from_when_it_was(watch: PictureWatch) -> None:
    watch.on_state(1, 0.0)
    watch.on_state(2, 0.9)
    watch.on_displayed(1, 0.9)
    assert not watch.stands_still(0.9 + STILL_AFTER_S)
    assert watch.stands_still(0.91 + STILL_AFTER_S)


def test_another_run_of_the_sim_counts_its_ticks_anew(watch: PictureWatch) -> None:
    watch.on_state(900, 0.0)
    watch.on_displayed(900, 0.0)
    watch.on_state(1, 1.0)
    watch.on_displayed(900, 1.1)  # the old picture, once more
    assert watch.stands_still(2.1)
    watch.on_displayed(1, 2.2)
    assert not watch.stands_still(9.0)


def test_where_no_page_reports_what_was_drawn_counts(watch: PictureWatch) -> None:
    for tick in range(1, 100):
        watch.on_state(tick, tick * TICK_S)
        watch.on_drawn(tick, tick * TICK_S)
    assert not watch.stands_still(99 * TICK_S)
    watch.on_state(100, 5.0)
    assert watch.stands_still(6.1)  # nothing is drawn any more
    watch.on_displayed(100, 6.2)
    watch.on_state(101, 6.3)
    watch.on_drawn(101, 6.3)
    assert watch.stands_still(7.4)  # drawn, and not displayed


@given(st.lists(st.tuples(st.sampled_from(["on_state", "on_drawn", "on_displayed"]), st.integers(0, 50))))
def test_a_seat_without_a_page_drives_by_nothing(words: list[tuple[str, int]]) -> None:
    watch = PictureWatch()
    for word, tick in words:
        getattr(watch, word)(tick, 0.0)
    assert not watch.stands_still(1e9)
