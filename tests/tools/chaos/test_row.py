"""How a row of the fault table is judged. Nothing is started here."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol.messages import Event
from tools.chaos.faults import every_fault
from tools.chaos.report import write_table
from tools.chaos.row import RecordedFile, Row, in_words, judge, lost, standstill, told
from tools.chaos.witness import Shown

TICK_S = 0.05
FAULT_S = 10.0


def states(*gaps: tuple[float, float]) -> list[tuple[float, int, int]]:
    """A state every tick for 20 s, but for the gaps (from, to)."""
    times = [number * TICK_S for number in range(400)]
    return [(at_s, n, 1) for n, at_s in enumerate(times) if not any(a < at_s < b for a, b in gaps)]


def test_the_longest_standstill_counts_from_the_fault_and_says_when_it_was_over() -> None:
    longest, back_s = standstill(states((2.0, 4.0), (9.9, 13.0)), [], FAULT_S)
    assert longest == pytest.approx(3.0, abs=0.11)
    assert back_s == pytest.approx(3.0, abs=0.11)
    assert standstill(states((10.5, 10.8)), [], FAULT_S)[1] == 0.0


def test_the_pause_at_an_episodes_end_is_no_standstill() -> None:
    ended = Event(episode_ended=Event.EpisodeEnded(number=1))
    assert standstill(states((12.0, 14.0)), [(12.1, ended)], FAULT_S)[1] == 0.0
    assert standstill(states((12.0, 14.0)), [(14.1, ended)], FAULT_S)[1] == pytest.approx(4.0, abs=0.11)


def test_only_words_that_name_it_count_as_told() -> None:
    shown = [
        Shown(9.0, "room-1 does not answer"),
        Shown(10.2, "A guest came."),
        Shown(10.7, "ROOM-1 is gone"),
    ]
    after_s, words = told(shown, ("room-1",), FAULT_S)
    assert after_s == pytest.approx(0.7)
    assert words == "ROOM-1 is gone"
    assert told(shown, ("recorder",), FAULT_S) == (None, "")


def test_what_is_in_no_file_is_lost() -> None:
    pieces = [
        RecordedFile(frozenset(range(50)), "unspecified", "verified", False),
        RecordedFile(frozenset(range(60, 100)), "success", "verified", True),
    ]
    expected = frozenset(range(100))
    assert lost(expected, pieces) == pytest.approx(10 * TICK_S)
    assert lost(expected, []) == pytest.approx(100 * TICK_S)
    assert in_words(pieces, expected).count("says that it is not whole") == 1
    assert in_words([], expected) == "no file"


@pytest.mark.parametrize(
    ("changes", "short"),
    [
        ({}, []),
        ({"lost_s": 1.5}, ["1.5 s are lost"]),
        ({"gap_named": False}, ["neither verified nor its gap named"]),
        ({"told_s": None}, ["nobody is told"]),
        ({"told_s": 0.9}, ["told 0.9 s after it is felt"]),
        ({"next_verified": False}, ["the next episode is not verified"]),
        ({"left_over": 3}, ["3 processes are left"]),
    ],
)
def test_a_row_says_where_it_falls_short(changes: dict[str, object], short: list[str]) -> None:
    row = Row(**{"fault": "kill-sim", "told_s": 0.2, "next_verified": True, **changes})  # type: ignore[arg-type]
    assert judge(row, ("room-1",), felt=True, ends_platform=False) == short
    assert judge(Row("kill-replica", next_verified=True), ("room-1",), felt=False, ends_platform=False) == []


def test_the_table_stands_between_its_marks(tmp_path: Path) -> None:
    page = tmp_path / "reliability.md"
    page.write_text("# Title\n<!-- chaos: begin -->\nearlier\n<!-- chaos: end -->\nafter\n")
    write_table(page, [Row("kill-sim", told="a | b"), Row("read-only", not_here="no mounts")])
    text = page.read_text()
    assert text.startswith("# Title\n<!-- chaos: begin -->\n| fault |")
    assert text.endswith("<!-- chaos: end -->\nafter\n")
    assert "earlier" not in text
    assert "a \\| b" in text
    assert "not tried: no mounts" in text
    columns = {line.replace("\\|", "").count("|") for line in text.splitlines() if line.startswith("|")}
    assert len(columns) == 1


def test_every_fault_has_a_name_of_its_own() -> None:
    names = [fault.name for fault in every_fault()]
    assert len(set(names)) == len(names)
