"""What the Episodes page makes of edits: ticks and seconds, where playing goes on, in a real Chromium."""

from __future__ import annotations

import pytest

from tests.browser.pages.conftest import Run

TIMES = {"ticks": [0, 10, 20], "seconds": [0, 0.5, 1.5]}
CUT_AND_SKIP = {"cuts": [{"begin": 0, "end": 5}], "skips": [{"begin": 5, "end": 10}], "splits": [15]}


@pytest.mark.parametrize(("tick", "seconds"), [(0, 0.0), (4, 0.2), (10, 0.5), (15, 1.0), (20, 1.5)])
def test_ticks_and_seconds_are_each_others(run: Run, tick: int, seconds: float) -> None:
    told = run(
        "episodes/edits.js",
        "({ tickAt, secondsAt }, [times, tick, at]) => [tickAt(times, at), secondsAt(times, tick)]",
        [TIMES, tick, seconds],
    )
    assert told == [tick, pytest.approx(seconds)]


@pytest.mark.parametrize(("at", "goes_on"), [(0.0, 0.5), (0.3, 0.5), (0.5, 0.5), (1.2, 1.2)])
def test_playing_jumps_over_all_that_is_left_out(run: Run, at: float, goes_on: float) -> None:
    jump = "({ editSpans, goesOnAt }, [edits, times, at]) => goesOnAt(editSpans(edits, times), at)"
    assert run("episodes/edits.js", jump, [CUT_AND_SKIP, TIMES, at]) == pytest.approx(goes_on)


def test_what_people_say_of_a_subtask_is_in_its_lane(run: Run) -> None:
    lanes: list[dict[str, object]] = [
        {"kind": "subtask", "name": name, "title": name, "spans": []} for name in ("grasp", "lift")
    ]
    edits = {"subtasks": {"grasp": "10", "lift": "-1"}}
    told = run(
        "episodes/edits.js",
        "({ editedLanes }, [lanes, edits, times]) => editedLanes(lanes, edits, times).map(({ spans }) => spans)",
        [lanes, edits, TIMES],
    )
    assert told == [[{"begin_s": 0.5, "end_s": 1.5, "text": "done"}], []]
