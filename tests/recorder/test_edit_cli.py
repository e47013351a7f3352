"""`mart episodes edit` as people and scripts use it: real files, real labels."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes.folder import described
from tests.recorder.conftest import Mart
from tests.recorder.files import write_episode, write_moving


def edited(mart: Mart, path: Path, *options: object) -> dict[str, object]:
    (found,) = mart.json("episodes", "edit", path, *options)["episodes"]
    assert isinstance(found, dict)
    return found


def test_it_says_what_is_left_and_the_file_stays(mart: Mart, path: Path) -> None:
    before = path.read_bytes()
    assert "not edited" in mart("episodes", "edit", path)
    told = edited(mart, path, "--cut", "0-3", "--skip", "10-12", "--split", "20")
    assert (told["ticks"], told["kept_ticks"]) == (30, 25)
    assert told["segments"] == [[[3, 10], [12, 20]], [[20, 30]]]
    assert "25 of 30 ticks, 2 segments" in mart("episodes", "edit", path)
    assert "25 of 30 ticks, 2 segments" in mart("episodes", "list")
    assert path.read_bytes() == before


def test_what_is_said_at_once_is_undone_at_once_and_done_again(mart: Mart, path: Path) -> None:
    edited(mart, path, "--cut", "0-3", "--split", "20")
    edited(mart, path, "--cut", "25-30")
    assert edited(mart, path, "--undo")["kept_ticks"] == 27
    assert edited(mart, path, "--undo")["kept_ticks"] == 30
    assert "has no edits" in mart("episodes", "edit", path, "--undo", code=1)
    assert edited(mart, path, "--redo")["kept_ticks"] == 27
    assert edited(mart, path, "--redo")["kept_ticks"] == 22
    assert "nothing can be done again" in mart("episodes", "edit", path, "--redo", code=1)
    assert edited(mart, path, "--undo")["kept_ticks"] == 27
    edited(mart, path, "--skip", "9-10")
    assert "nothing can be done again" in mart("episodes", "edit", path, "--redo", code=1)


def test_times_become_ticks(mart: Mart, path: Path) -> None:
    told = edited(mart, path, "--cut", "0s-0.5s", "--split", "1s")
    assert told["segments"] == [[[10, 20]], [[20, 30]]]


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (("--cut", "20-31"), "has 30 ticks"),
        (("--cut", "5-5"), "name the first and the one after the last"),
        (("--split", "30"), "the last that can be said is 29"),
        (("--subtask", "dance=3"), "The subtask 'dance' was given"),
        (("--cut", "0-30"), "Nothing would be left"),
        (("--cut", "0-3", "--undo"), "one of them can be done at a time"),
        (("--skip-idle", "0.1"), "at least 0.2 s"),
    ],
)
def test_what_cannot_be_is_a_sentence_and_nothing_is_written(
    mart: Mart, path: Path, options: tuple[str, ...], why: str
) -> None:
    other = write_episode(mart.episodes_dir, number=2).path
    said = mart("episodes", "edit", other, path, "--cut", "1-2", *options, code=1)
    assert why in said
    assert "Traceback" not in said
    assert all("not edited" in mart("episodes", "edit", one) for one in (path, other))


def test_a_subtask_is_told_otherwise(mart: Mart, path: Path) -> None:
    name = described([path])[0].recorded_task().subtasks[0].name
    edited(mart, path, "--subtask", f"{name}=12")
    assert described([path])[0].edits.subtasks == {name: 12}
    edited(mart, path, "--subtask", f"{name}=never")
    assert described([path])[0].edits.subtasks == {name: None}


def test_idle_time_is_found_once(mart: Mart) -> None:
    path = write_moving(mart.episodes_dir, still=range(10, 21))
    told = edited(mart, path, "--skip-idle", "0.5", "--cut", "0-2")
    assert told["segments"] == [[[2, 10], [20, 30]]]
    assert edited(mart, path, "--skip-idle", "0.5")["act_ns"] is None
    assert edited(mart, path, "--undo")["kept_ticks"] == 30
