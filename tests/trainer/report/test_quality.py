"""The quality report: what the command prints and writes, from files of the toy room."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path

import pytest
from click.testing import CliRunner

from mart.episodes import LabelKind, labels
from mart.episodes.quality.store import FILE_NAME
from mart.protocol.errors import NotFound
from mart.trainer.report.cli import report
from tests.recorder.files import write_episode


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Eight short episodes and a long one."""
    folder = tmp_path_factory.mktemp("episodes")
    for number in range(1, 10):
        write_episode(folder, ticks=400 if number == 9 else 20, number=number)
    return folder


def run(*words: object) -> str:
    return CliRunner().invoke(report, ["quality", *map(str, words)], catch_exceptions=False).output


def test_the_table_compares_and_below_it_stands_what_is_unlike_the_others(root: Path) -> None:
    text = run(root)
    assert "1 of 9 episodes are unlike the others:" in text
    assert "0009" in text.splitlines()[-1]
    assert "Length: 20.0 times the median, 1 s" in text
    assert text.splitlines()[2].split()[:4] == ["Ana", "9", "9", "1"]
    assert text.splitlines()[3].split()[:4] == ["hold", "9", "9", "1"]
    assert (root / FILE_NAME).exists()


@pytest.mark.parametrize("by", ["operator", "day", "episode"])
def test_json_has_everything_that_was_measured(root: Path, by: str) -> None:
    (task,) = json.loads(run(root, "--by", by, "--json"))["tasks"]
    assert len(task["episodes"]) == 9
    assert task["episodes"][0]["quality"]["arms"]["arm1"]["held_share"] == 1.0
    assert [one["name"] for one in task["groups"]] == {
        "operator": ["Ana", "hold"],
        "day": ["2026-09-21"],
        "episode": [],
    }[by]


def test_the_page_links_what_is_unlike_the_others(root: Path, tmp_path: Path) -> None:
    page = tmp_path / "quality.html"
    run(root, "--out", page)
    text = page.read_text(encoding="utf-8")
    HTMLParser().feed(text)
    assert f'href="{root.as_uri()}/2026-09-21/room-1-0009-' in text
    assert text.count("<svg") == 2


def test_a_dropped_episode_and_another_task_are_left_out(tmp_path: Path) -> None:
    path = write_episode(tmp_path, ticks=20).path
    assert "Too few" in run(tmp_path)
    with pytest.raises(NotFound):
        run(tmp_path, "--task", "two_arm_pick_place_handover")
    labels.say(path, LabelKind.USE, labels.DROP, at_ns=1)
    with pytest.raises(NotFound):
        run(tmp_path)
