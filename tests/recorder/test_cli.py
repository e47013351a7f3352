"""`mart episodes …` as people and scripts use it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from mart.episodes.labels import LabelKind, read, say
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


def test_show_says_whose_pictures_are_there(mart: Mart, path: Path) -> None:
    assert mart.json("episodes", "show", path)["pictures"] == "recorded of arm0"


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


@pytest.fixture
def foreign(path: Path) -> Path:
    """A folder with one episode of MART's and one file of another project."""
    found = path.with_name("talker.mcap")
    found.write_bytes(b"\x89MCAP0\r\n\x01\x0c\0\0\0\0\0\0\0\x04\0\0\0ros2\0\0\0\0" + bytes(20))
    return found


@pytest.fixture
def replica(monkeypatch: pytest.MonkeyPatch) -> None:
    @contextmanager
    def toy(_replica: str | None, *, wherever_possible: bool = False) -> Iterator[object]:
        assert not wherever_possible
        yield synthetic.ToyReplica()

    monkeypatch.setattr("mart.recorder.cli.resimulation", toy)


@pytest.mark.usefixtures("replica")
def test_verify_tells_what_it_did_whatever_else_lies_there(
    mart: Mart, path: Path, foreign: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert "verified" in mart("episodes", "verify", path.parent)
    assert f"Left out: {foreign} is an MCAP file of another kind" in caplog.text
    told = mart.json("episodes", "verify", path.parent)
    assert [one["path"] for one in told["episodes"]] == [str(path)]
    assert [one["path"] for one in told["left_out"]] == [str(foreign)]
    assert "of another kind" in mart("episodes", "verify", path, foreign, code=1)
    cut = path.with_name("cut.mcap")
    cut.write_bytes(path.read_bytes()[:3000])
    assert "verified" in mart("episodes", "verify", path.parent, code=1)  # one of MART's is damaged
    mart("episodes", "label", "--drop", cut)
    assert "verified" in mart("episodes", "verify", path.parent)


def test_a_file_that_is_not_ours_is_in_nobodys_way(mart: Mart, path: Path, foreign: Path) -> None:
    rows = {one["path"]: one for one in mart.json("episodes", "list", path.parent)["episodes"]}
    assert rows[str(path)]["error"] is None
    assert (rows[str(foreign)]["foreign"], rows[str(path)]["foreign"]) == (True, False)
    assert mart.json("datasets", "create", "good")["count"] == 1
    assert "of another kind" in mart("datasets", "add", "good", foreign, code=1)
    assert "of another kind" in mart("episodes", "show", foreign, code=1)
    before = foreign.read_bytes()
    assert "left alone" in mart("episodes", "repair", path.parent)
    assert foreign.read_bytes() == before


def test_repair_takes_files_and_says_what_they_are(mart: Mart, path: Path) -> None:
    damaged = path.with_name("cut.mcap")
    data = path.read_bytes()
    damaged.write_bytes(data[: len(data) * 2 // 3])
    (one,) = mart.json("episodes", "repair", damaged)["repaired"]
    assert (one["file"], one["path"]) == (str(damaged), str(path.with_name("cut.repaired.mcap")))
    assert "whole" in mart("episodes", "repair", path)
    pointer = path.with_name("pointer.mcap")
    pointer.write_bytes(b"version https://git-lfs.github.com/spec/v1\n")
    assert "git lfs pull" in mart("episodes", "repair", pointer, code=1)
    assert "There is no" in mart("episodes", "repair", path.with_name("none.mcap"), code=1)


def test_what_a_file_says_does_not_steer_the_terminal(mart: Mart, path: Path) -> None:
    labels_of(path, "\x1b[2Jgone\nnew line")
    for command in (("list",), ("show", path)):
        printed = mart("episodes", *command)
        assert "\x1b" not in printed
        assert "\ufffd[2Jgone\ufffdnew line" in printed


def labels_of(path: Path, note: str) -> None:
    say(path, LabelKind.NOTE, note, 1)
