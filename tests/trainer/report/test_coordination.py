"""Table I: from episode files to the marginal degradation of each kind of subtask."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes import labels
from mart.protocol.errors import NotFound
from mart.protocol.tasks import Subtask, Task, get_task
from mart.trainer.report import paper
from mart.trainer.report.attempts import read_attempts
from mart.trainer.report.cli import report
from mart.trainer.report.coordination import Attempt, coordination
from tests.trainer.made_up_rollouts import write_footage

WIPING = get_task(paper.WIPING)
ASSEMBLY = replace(
    WIPING,
    name=paper.ASSEMBLY,
    subtasks=tuple(
        Subtask(name, name, coordinated=name.startswith("tabletop"))
        for name in ("column0", "column1", "tabletop_up", "tabletop_on")
    ),
)


def reached(task: Task, counts: Sequence[int]) -> list[Attempt]:
    """`counts[k]` attempts that did the first k subtasks; the last of them succeed."""
    names = [subtask.name for subtask in task.subtasks]
    return [
        Attempt(frozenset(names[:done]), done == len(names))
        for done, count in enumerate(counts)
        for _ in range(count)
    ]


def test_the_papers_figures_come_out_where_uncoordinated_work_comes_first() -> None:
    # 100 % − 61.7 % and 61.7 % − 49.1 %, of 1000 attempts
    found = coordination(ASSEMBLY, reached(ASSEMBLY, (200, 183, 100, 26, 491)))
    uncoordinated, coordinated = (found.degradation(coordinated=kind) for kind in (False, True))
    assert uncoordinated is not None
    assert coordinated is not None
    assert (100 * uncoordinated.value, 100 * coordinated.value) == pytest.approx(
        paper.DEGRADATION[paper.ASSEMBLY]
    )


def test_the_order_is_reversed_where_coordinated_work_comes_first() -> None:
    # 100 % − 61.8 % and 61.8 % − 32.6 %
    found = coordination(WIPING, reached(WIPING, (300, 82, 292, 326)))
    uncoordinated, coordinated = (found.degradation(coordinated=kind) for kind in (False, True))
    assert uncoordinated is not None
    assert coordinated is not None
    assert (100 * uncoordinated.value, 100 * coordinated.value) == pytest.approx(
        paper.DEGRADATION[paper.WIPING]
    )


def test_a_task_of_one_kind_has_no_other() -> None:
    task = get_task(paper.CUBES)
    assert coordination(task, reached(task, (1, 1, 1))).degradation(coordinated=True) is None


@given(st.lists(st.sets(st.sampled_from([subtask.name for subtask in ASSEMBLY.subtasks])), min_size=1))
def test_what_is_lost_and_what_is_left_are_all(dones: list[set[str]]) -> None:
    attempts = [Attempt(frozenset(done), len(done) == len(ASSEMBLY.subtasks)) for done in dones]
    found = coordination(ASSEMBLY, attempts)
    lost = [rate for kind in (False, True) if (rate := found.degradation(coordinated=kind)) is not None]
    assert sum(rate.hits for rate in lost) + found.stages[-1].passed == len(dones)
    assert all(stage.passed <= stage.entered for stage in found.stages)


def test_what_was_reached_and_lost_again_is_lost_in_the_last_stage() -> None:
    names = frozenset(subtask.name for subtask in WIPING.subtasks)
    found = coordination(WIPING, [Attempt(names, success=True), Attempt(names, success=False)])
    assert [(stage.entered, stage.passed) for stage in found.stages] == [(2, 2), (2, 1)]


def test_a_subtask_out_of_order_does_not_count_as_a_stage() -> None:
    last: Subtask = ASSEMBLY.subtasks[-1]
    found = coordination(ASSEMBLY, [Attempt(frozenset({last.name}), success=False)])
    assert [(stage.entered, stage.passed) for stage in found.stages] == [(1, 0), (0, 0)]


@pytest.fixture
def episodes(tmp_path: Path) -> Path:
    names = [subtask.name for subtask in WIPING.subtasks]
    for number, (done, outcome) in enumerate(
        [(names, "success"), (names[:2], "failure"), (names[:1], "failure"), (names[:2], "discarded")]
    ):
        write_footage(tmp_path, number, WIPING.name, done, outcome)
    return tmp_path


def test_files_tell_what_was_done_at_any_time(episodes: Path) -> None:
    (found,) = read_attempts(episodes)
    assert found.task.name == WIPING.name
    assert [len(attempt.done) for attempt in found.attempts] == [3, 2, 1]
    assert [attempt.success for attempt in found.attempts] == [True, False, False]


def test_a_file_that_is_not_ours_is_left_out_and_said(
    episodes: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (episodes / "talker.mcap").write_bytes(b"#ROSBAG V2.0\n")
    (found,) = read_attempts(episodes)
    assert len(found.attempts) == 3
    assert "talker.mcap is a bag of ROS 1" in caplog.text


def test_a_label_goes_before_the_recorded_outcome(episodes: Path) -> None:
    labels.say(sorted(episodes.glob("*.mcap"))[1], labels.LabelKind.OUTCOME, "discarded", 1)
    (found,) = read_attempts(episodes)
    assert len(found.attempts) == 2


def test_the_command_prints_ours_beside_the_papers(episodes: Path) -> None:
    text = CliRunner().invoke(report, ["coordination", str(episodes)], catch_exceptions=False).output
    assert "uncoordinated  33.3 (6–79)" in text
    assert "paper 29.2" in text
    out = CliRunner().invoke(report, ["coordination", str(episodes), "--json"], catch_exceptions=False).output
    (row,) = json.loads(out)["tasks"]
    assert row["degradation"]["coordinated"]["value"] == pytest.approx(100 / 3)


def test_an_empty_folder_is_said(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        read_attempts(tmp_path)
