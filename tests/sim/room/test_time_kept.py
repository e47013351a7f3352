"""How fast a room really ticked: most of the time, without what it waited for or what was over in a moment."""

from __future__ import annotations

from mart.sim.room.time_kept import TimeKept

STALLED_AFTER_S = 0.25


def ticked(kept: TimeKept, from_s: float, seconds: float, rate_hz: float) -> float:
    """Ticks evenly; when the last one was."""
    ticks = round(seconds * rate_hz)
    for number in range(ticks):
        kept.ticked(from_s + (number + 1) * seconds / ticks)
    return from_s + seconds


def test_a_moment_tells_nothing() -> None:
    kept = TimeKept(STALLED_AFTER_S)
    ticked(kept, 0.0, 5.5, 20.0)
    assert kept.ticks_per_s() is None


def test_most_of_the_time_counts() -> None:
    kept = TimeKept(STALLED_AFTER_S)
    ticked(kept, ticked(kept, 0.0, 4.0, 10.0), 8.0, 20.0)
    assert abs((kept.ticks_per_s() or 0.0) - 20.0) < 0.5


def test_what_is_over_counts_no_more_and_what_goes_on_does() -> None:
    kept = TimeKept(STALLED_AFTER_S)
    end_s = ticked(kept, ticked(kept, 0.0, 10.0, 10.0), 6.5, 20.0)
    assert abs((kept.ticks_per_s() or 0.0) - 20.0) < 0.5
    ticked(kept, end_s, 12.0, 15.0)
    assert abs((kept.ticks_per_s() or 0.0) - 15.0) < 0.5


def test_what_was_waited_for_and_a_world_that_began_anew_are_left_out() -> None:
    kept = TimeKept(STALLED_AFTER_S)
    now_s = 0.0
    for _ in range(10):
        now_s = ticked(kept, now_s, 1.0, 20.0) + 3.0
        kept.interrupt()
        now_s += 0.2  # nothing was due
    assert abs((kept.ticks_per_s() or 0.0) - 20.0) < 0.5


def test_what_is_forgotten_counts_no_more() -> None:
    kept = TimeKept(STALLED_AFTER_S)
    end_s = ticked(kept, 0.0, 8.0, 10.0)
    kept.forget()
    assert kept.ticks_per_s() is None
    ticked(kept, end_s, 8.0, 20.0)
    assert abs((kept.ticks_per_s() or 0.0) - 20.0) < 0.5
