"""When ticks are due, and the real-time factor."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.sim.room.pacing import CATCH_UP_TICKS, Pace, RealTimeFactor

PERIOD_S = 0.05


def fire_when_due(pace: Pace, delays_s: list[float]) -> list[float]:
    """Each tick fires `delay` after it was due, or after the last one."""
    now_s, fired = 0.0, []
    for delay_s in delays_s:
        now_s = max(now_s, pace.due_s) + delay_s
        pace.fired(now_s)
        fired.append(now_s)
    return fired


@given(st.lists(st.floats(0.0, 3.0), min_size=1, max_size=60))
def test_no_stretch_of_time_holds_more_ticks_than_real_time_and_the_catch_up(delays_s: list[float]) -> None:
    fired = fire_when_due(Pace(PERIOD_S, 0.0), delays_s)
    for first, began_s in enumerate(fired):
        for last in range(first, len(fired)):
            stretch_s = fired[last] - began_s
            assert last - first + 1 <= stretch_s / PERIOD_S + 1 + CATCH_UP_TICKS + 1e-6


@given(st.lists(st.floats(0.0, 3.0), min_size=1, max_size=60))
def test_never_ahead_of_real_time_since_the_start(delays_s: list[float]) -> None:
    for number, fired_s in enumerate(fire_when_due(Pace(PERIOD_S, 0.0), delays_s)):
        assert number * PERIOD_S <= fired_s + 1e-9


@given(st.lists(st.floats(0.0, PERIOD_S), min_size=1, max_size=60))
def test_a_little_lateness_does_not_slow_the_rhythm(delays_s: list[float]) -> None:
    pace = Pace(PERIOD_S, 0.0)
    for number, delay_s in enumerate(delays_s):
        assert pace.due_s == pytest.approx(number * PERIOD_S)
        pace.fired(pace.due_s + delay_s)


def test_after_a_stall_at_most_two_ticks_are_caught_up() -> None:
    pace = Pace(PERIOD_S, 0.0)
    pace.fired(0.0)
    after_stall_s, ticks = 60.0, 0
    while pace.due_s <= after_stall_s:
        pace.fired(after_stall_s)
        ticks += 1
    assert ticks == 1 + 2
    assert pace.due_s == pytest.approx(after_stall_s + PERIOD_S)


def test_a_restart_leaves_nothing_to_catch_up_with() -> None:
    pace = Pace(PERIOD_S, 0.0)
    pace.restart(60.0)
    pace.fired(60.0)
    assert pace.due_s == pytest.approx(60.0 + PERIOD_S)


def test_the_factor_is_one_at_full_pace() -> None:
    factor = RealTimeFactor(PERIOD_S, 0.0)
    for tick in range(200):
        factor.ticked(tick * PERIOD_S)
        assert factor.value(tick * PERIOD_S) == pytest.approx(1.0)
        assert factor.value(tick * PERIOD_S + 0.9 * PERIOD_S) == pytest.approx(1.0)


def test_the_factor_tells_half_speed() -> None:
    factor = RealTimeFactor(PERIOD_S, 0.0)
    for tick in range(200):
        factor.ticked(2 * tick * PERIOD_S)
    assert factor.value(2 * 199 * PERIOD_S) == pytest.approx(0.5, rel=0.03)


def test_the_factor_falls_to_nothing_in_a_stall() -> None:
    factor = RealTimeFactor(PERIOD_S, 0.0)
    for tick in range(100):
        factor.ticked(tick * PERIOD_S)
    values = [factor.value(5.0 + stall_s) for stall_s in (0.5, 1.0, 1.5, 3.0)]
    assert values == sorted(values, reverse=True)
    assert values[-1] == 0.0


def test_the_factor_begins_anew_with_the_world() -> None:
    factor = RealTimeFactor(PERIOD_S, 0.0)
    factor.restart(100.0)
    assert factor.value(100.0) == 1.0
    factor.ticked(100.0)
    assert factor.value(100.0) == 1.0
