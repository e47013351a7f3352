"""`mart episodes …` as people and scripts use it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mart.episodes.labels import LabelKind, read
from mart.protocol.messages import ENDED_BY_OPERATOR
from mart.recorder.record.finalize import finalize
from tests.recorder import synthetic
from tests.recorder.conftest import Mart
from tests.recorder.files import by_toy_replica, write_part


def test_list_json_has_what_scripts_ask_for(mart: Mart, path: Path) -> None:
    (row,) = mart.json("episodes", "list")["episodes"]
    assert row["path"] == str(path)
    assert (row["task"], row["outcome"], row["verified"], row["ticks"]) == (
        synthetic.TASK,
        "success",
        True,
        30,
    )
    assert row["real_time_factor"] == pytest.approx(1.0)
    assert row["operators"] == {"arm0": "human Ana", "arm1": "hold"}


@pytest.mark.parametrize("what", ["root", "day", "file", "nothing"])
def test_list_takes_files_and_folders(mart: Mart, path: Path, what: str) -> None:
    given = {"root": [path.parents[1]], "day": [path.parent], "file": [path], "nothing": []}[what]
    assert len(mart.json("episodes", "list", *given)["episodes"]) == 1
    assert "human Ana" in mart("episodes", "list", *given)


def test_a_day_gets_no_catalogue_of_its_own(mart: Mart, path: Path) -> None:
    mart("episodes", "list", path.parent)
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_list_tells_a_success_that_was_only_said(mart: Mart) -> None:
    states = synthetic.states(5)
    for name in ("lift", "carry", "put"):
        states[-1].progress.subtasks.add(name=name)
    file, episode, facts = write_part(mart.episodes_dir, states)
    end = synthetic.ended(5)
    end.episode_ended.ended_by = ENDED_BY_OPERATOR
    episode.add_event(end)
    saved = finalize(file, episode, facts, mart.episodes_dir, by_toy_replica, repaired=False)
    assert re.search(r"success .*said by an operator, 0 of 3 steps", mart("episodes", "list"))
    shown = mart.json("episodes", "show", saved.path)
    assert (shown["ended_by"], shown["subtasks_done"], shown["subtasks"]) == ("operator", 0, 3)


def test_check_counts_what_a_file_lacks(mart: Mart, path: Path) -> None:
    assert mart("episodes", "check", path) == f"{path}: whole.\n"
    states = synthetic.states(5)
    states[-1].arms[0].sequence = 99
    file, episode, facts = write_part(mart.episodes_dir, [*synthetic.without(states, 3)])
    saved = finalize(file, episode, facts, mart.episodes_dir, by_toy_replica, repaired=False)
    lacking = mart.json("episodes", "check", saved.path, code=1)["episodes"]
    assert [(one["missing_ticks"], one["missing_commands"], one["whole"]) for one in lacking] == [
        (1, 2, False)
    ]
    assert "2 commands missing" in mart("episodes", "list", saved.path)


def test_without_episodes_it_says_so(mart: Mart) -> None:
    assert mart("episodes", "list") == "There are no episodes.\n"
    assert mart.json("episodes", "list") == {"episodes": []}


def test_show_tells_all(mart: Mart, path: Path) -> None:
    metadata = mart.json("episodes", "show", path)["metadata"]
    assert metadata["mart.episode"]["room"] == synthetic.ROOM
    assert "waited_for_arm1_s" in mart("episodes", "show", path)


def test_show_says_how_the_model_stands(mart: Mart, path: Path) -> None:
    assert "intact" in mart.json("episodes", "show", path)["model"]
    data = bytearray(path.read_bytes())
    data[data.index(synthetic.MJB)] ^= 1
    path.write_bytes(data)
    assert "does not match its checksum" in mart.json("episodes", "show", path)["model"]
    assert mart.json("episodes", "list", path)["episodes"][0]["error"] is None


def test_labels_are_laid_over_and_the_file_is_untouched(mart: Mart, path: Path) -> None:
    before = path.read_bytes()
    mart("episodes", "label", path, "--outcome", "failure", "--note", "cube slipped", "--drop")
    (row,) = mart.json("episodes", "list")["episodes"]
    assert (row["outcome"], row["note"], row["dropped"]) == ("failure", "cube slipped", True)
    mart("episodes", "label", path, "--undrop")
    assert not mart.json("episodes", "list")["episodes"][0]["dropped"]
    assert [label.kind for label in read(mart.episodes_dir)] == [
        LabelKind.OUTCOME,
        LabelKind.NOTE,
        LabelKind.USE,
        LabelKind.USE,
    ]
    assert path.read_bytes() == before


def test_repair_needs_no_router(mart: Mart) -> None:
    file, _, _ = write_part(mart.episodes_dir, synthetic.states(10))
    file.flush()
    file.abandon()
    (one,) = mart.json("episodes", "repair")["repaired"]
    assert one["file"] == str(file.path)
    assert mart.json("episodes", "list")["episodes"][0]["verdict"] == "unverified"
    assert mart("episodes", "repair") == "There is nothing to repair.\n"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("list", "nowhere"), "There is no nowhere"),
        (("show", "nowhere.mcap"), "There is no file nowhere.mcap"),
        (("verify",), "Could not reach a router"),
        (("label", "{path}"), "Nothing to say was given"),
        (("label", "{path}", "--note", "x" * 3000), "A note of 3000 characters was given"),
        (("replay", "{path}"), "Could not reach a router"),
    ],
)
def test_a_failure_is_one_line(mart: Mart, path: Path, arguments: tuple[str, ...], sentence: str) -> None:
    said = mart("episodes", *(argument.format(path=path) for argument in arguments), code=1)
    assert re.fullmatch(r"mart: .+\n", said)
    assert sentence in said


def test_a_broken_file_is_named(mart: Mart, path: Path) -> None:
    path.write_bytes(path.read_bytes()[:5000])
    assert "is damaged" in mart("episodes", "show", path, code=1)
    assert "is damaged" in mart("episodes", "list")
