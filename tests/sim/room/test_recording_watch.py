"""Whether somebody keeps an episode: any reports and ticks, and the objection is right."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import RecordingReport
from mart.sim.room.recording_watch import UNKEPT_AFTER_S, RecordingWatch

PERIOD_S = 0.05
BOOT_NS = 1_700_000_000_000_000_000


def report(tick: int, number: int = 1) -> RecordingReport:
    return RecordingReport(recorder="recorder-1", boot=BOOT_NS, episode=number, last_tick=tick)


@given(st.lists(st.integers(0, 40), min_size=40, max_size=40))
def test_it_objects_when_the_oldest_state_that_is_not_kept_is_too_old(behind: list[int]) -> None:
    watch, kept = RecordingWatch(BOOT_NS), -1
    for tick, lag in enumerate(behind):
        now_s = tick * PERIOD_S
        watch.told(1, tick, now_s)
        if tick >= lag:
            kept = max(kept, tick - lag)
            watch.reported(report(tick - lag))
        unkept_s = now_s - (kept + 1) * PERIOD_S
        assert bool(watch.objection(now_s)) == (kept < tick and unkept_s >= UNKEPT_AFTER_S)


def test_a_room_that_stands_still_or_practises_has_nothing_to_keep() -> None:
    watch = RecordingWatch(BOOT_NS)
    watch.told(1, 7, 0.0)
    watch.reported(report(7))
    assert watch.objection(100.0) == ""
    watch.told(1, 8, 100.0)
    assert watch.objection(102.0)
    watch.told(0, 9, 102.0)
    assert watch.objection(200.0) == ""
    assert watch.news(200.0) is None


def test_reports_of_another_episode_mean_nothing() -> None:
    watch = RecordingWatch(BOOT_NS)
    watch.told(2, 7, 0.0)
    watch.reported(report(99, number=1))
    assert "nobody" in watch.objection(1.0)


def test_a_recorder_whose_process_ended_keeps_nothing_from_then_on() -> None:
    watch = RecordingWatch(BOOT_NS)
    watch.told(1, 7, 0.0)
    watch.reported(report(7))
    watch.gone("recorder-1")
    assert watch.objection(0.0) == ""  # everything that was told is kept
    watch.told(1, 8, 0.05)
    assert watch.news(0.05) == ("error", "This episode is not being recorded: recorder-1 is gone.")
    watch.reported(report(8))
    assert watch.news(0.1) == ("info", "recorder-1 records again.")


def test_another_recorder_that_ended_was_not_the_one_that_keeps_it() -> None:
    watch = RecordingWatch(BOOT_NS)
    watch.told(1, 7, 0.0)
    watch.reported(report(6))
    watch.gone("recorder-2")
    assert watch.objection(0.05) == ""
