"""A picture shows the newest tick that had come when it was captured, never a later one."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import CameraFrame
from mart.teleop_gateway.video.camera_feed import age_at_arrival_s
from mart.teleop_gateway.video.tick_times import TickTimes


@given(
    steps_s=st.lists(st.floats(0.0, 1.0), max_size=30),
    captured_s=st.floats(-1.0, 30.0),
)
def test_it_is_never_newer_than_what_had_come(steps_s: list[float], captured_s: float) -> None:
    times, came, now_s = TickTimes(), [(0, -10.0)], 0.0
    for tick, step_s in enumerate(steps_s, 1):
        now_s += step_s
        times.add(tick, 1, now_s)
        came.append((tick, now_s))
    assert times.tick_at(captured_s) == max(tick for tick, at_s in came if at_s <= captured_s)


def test_another_run_of_the_room_begins_anew() -> None:
    times = TickTimes()
    times.add(500, 1, 1.0)
    times.add(2, 2, 2.0)
    assert times.tick_at(1.5) == 0
    assert times.tick_at(2.5) == 2


def test_clocks_that_differ_by_minutes_make_no_picture_younger_or_older() -> None:
    frame = CameraFrame(captured_ns=1_000_000_000_000, age_s=0.01)
    sent_ns = frame.captured_ns + 10_000_000
    assert abs(age_at_arrival_s(frame, sent_ns + 5_000_000) - 0.015) < 1e-6
    for off_s in (-120, 120):
        assert age_at_arrival_s(frame, sent_ns + off_s * 1_000_000_000) == 0.01
