"""`mart datasets …` as people and scripts use it: real files, real labels, a real catalogue."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from mart.episodes import labels
from mart.protocol.messages import Model
from mart.recorder.catalogue.episode_catalogue import FILE_NAME
from tests.recorder import synthetic
from tests.recorder.conftest import Mart
from tests.recorder.files import write_episode


@pytest.fixture
def paths(mart: Mart) -> list[Path]:
    return [write_episode(mart.episodes_dir, ticks=10, number=number).path for number in (1, 2, 3)]


def held(mart: Mart, name: str) -> list[str]:
    return [Path(one["path"]).name[7:11] for one in mart.json("datasets", "show", name)["episodes"]]


def test_it_is_made_of_what_the_filters_let_through(mart: Mart, paths: list[Path]) -> None:
    mart("episodes", "label", paths[0], "--outcome", "failure")
    made = mart.json("datasets", "create", "good", "--task", synthetic.TASK, "--operator", "Ana")
    assert (made["name"], made["changed"], made["left_out"]) == ("good", 2, {})
    assert held(mart, "good") == ["0002", "0003"]
    mart("datasets", "create", "all", "--outcome", "any", "--verdict", "any")
    assert held(mart, "all") == ["0001", "0002", "0003"]
    listed = mart.json("episodes", "list", "--dataset", "good")["episodes"]
    assert [row["datasets"] for row in listed] == [["all", "good"]] * 2
    assert "all  3 episodes" in mart("datasets", "list")


def test_it_changes_by_name_and_every_change_is_taken_back(mart: Mart, paths: list[Path]) -> None:
    first = mart.json("datasets", "create", "few", paths[0])["sha256"]
    second = mart.json("datasets", "add", "few", paths[1], paths[2])["sha256"]
    assert first != second
    mart("datasets", "remove", "few", paths[2])
    assert held(mart, "few") == ["0001", "0002"]
    assert mart.json("datasets", "undo", "few")["sha256"] == second
    assert "it holds 0 now" in mart("datasets", "delete", "few")
    assert mart.json("datasets", "list") == {"datasets": []}
    assert mart.json("datasets", "undo", "few")["sha256"] == second
    assert all(path.is_file() for path in paths)


def test_it_outlives_the_catalogue(mart: Mart, paths: list[Path]) -> None:
    made = mart.json("datasets", "create", "good")
    (mart.episodes_dir / FILE_NAME).unlink()
    (mart.episodes_dir / FILE_NAME).write_bytes(b"torn")
    assert mart.json("datasets", "list")["datasets"][0]["sha256"] == made["sha256"]
    assert len(mart.json("episodes", "list", "--dataset", "good")["episodes"]) == 3


def test_what_nobody_learns_from_stays_out_and_is_said(mart: Mart, paths: list[Path]) -> None:
    mart("episodes", "label", paths[0], "--drop")
    mart("episodes", "label", paths[1], "--outcome", "discarded")
    assert "left out: 1 discarded, 1 dropped" in mart("datasets", "create", "good", "--outcome", "any")
    assert held(mart, "good") == ["0003"]
    paths[2].unlink()
    assert f"{paths[2].name} (deleted)" in mart("datasets", "show", "good")
    listed = paths[2].relative_to(mart.episodes_dir)
    assert "it holds 0 now" in mart("datasets", "remove", "good", listed)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            ("create", "Good data"),
            "The data set 'Good data' was given; name it with 1 to 64 lower-case letters",
        ),
        (
            ("create", "known"),
            "There is a data set 'known' already; add to it with `mart datasets add known`",
        ),
        (("add", "knwon"), "There is no data set 'knwon'. Did you mean 'known'?"),
        (("show", "new"), "There is no data set 'new'. Known: known."),
        (("remove", "known"), "Name episodes or give a filter; `mart datasets delete known` takes out all"),
        (("remove", "new", "{elsewhere}"), "name that folder with --folder"),
        (("create", "new", "--folder", "{day}"), "name that folder with --folder"),
        (("undo", "new"), "There never was a data set 'new'"),
        (("create", "new", "--task", "wipe"), "None of 3 episodes is let through by --task wipe"),
        (("create", "new", "nowhere"), "nowhere; name episode files or folders"),
        (("create", "new", "--folder", "nowhere"), "There is no folder"),
        (("create", "new", "{elsewhere}"), "name that folder with --folder"),
    ],
)
def test_a_failure_is_one_line(
    mart: Mart, paths: list[Path], tmp_path: Path, words: tuple[str, ...], sentence: str
) -> None:
    mart("datasets", "create", "known", paths[0])
    elsewhere = write_episode(tmp_path / "elsewhere", ticks=5).path
    before = labels.read(mart.episodes_dir)
    said = mart(
        "datasets", *(word.format(elsewhere=elsewhere, day=paths[0].parent) for word in words), code=1
    )
    assert re.fullmatch(r"mart: .+\n", said)
    assert sentence in said
    assert labels.read(mart.episodes_dir) == before


def test_a_folder_of_its_own(mart: Mart, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    write_episode(elsewhere, ticks=5)
    mart("datasets", "create", "there", "--folder", elsewhere)
    assert len(mart.json("datasets", "list", "--folder", elsewhere)["datasets"]) == 1


def test_several_become_one_and_back(mart: Mart, paths: list[Path]) -> None:
    mart("datasets", "create", "one", paths[0], paths[1])
    mart("datasets", "create", "two", paths[1], paths[2])
    merged = mart.json("datasets", "merge", "both", "one", "two")
    assert (merged["changed"], held(mart, "both")) == (3, ["0001", "0002", "0003"])
    assert held(mart, "one") == ["0001", "0002"]
    assert "There is a data set 'both' already" in mart("datasets", "merge", "both", "one", code=1)
    assert mart.json("datasets", "undo", "both")["count"] == 0


def test_what_does_not_belong_together_is_not_merged(mart: Mart, paths: list[Path], tmp_path: Path) -> None:
    mart("datasets", "create", "one", paths[0])
    assert "There is no data set" in mart("datasets", "merge", "both", "one", "gone", code=1)
    elsewhere = mart("datasets", "merge", "both", "one", tmp_path / "other" / "two", code=1)
    assert "only data sets of one folder" in elsewhere
    assert [one["name"] for one in mart.json("datasets", "list")["datasets"]] == ["one"]


@pytest.mark.parametrize(
    ("model", "told"),
    [
        ({"control_hz": 10.0}, "control_hz: 10 Hz (two); 20 Hz (one)."),
        ({"mujoco_version": "3.9.1"}, "MuJoCo 3.9 (two)"),
    ],
)
def test_rates_and_versions_that_differ_are_named_with_their_mend(
    mart: Mart, paths: list[Path], monkeypatch: pytest.MonkeyPatch, model: dict[str, Any], told: str
) -> None:
    field = "control_hz" if "control_hz" in model else "versions"
    other = Model()
    other.CopyFrom(synthetic.MODEL)
    for name, value in model.items():
        setattr(other, name, value)
    monkeypatch.setattr(synthetic, "MODEL", other)
    mart("datasets", "create", "one", paths[0])
    mart("datasets", "create", "two", write_episode(mart.episodes_dir, ticks=5, number=9).path)
    refused = mart("datasets", "merge", "both", "one", "two", code=1)
    assert told in refused
    assert f"`--allow {field}`" in refused
    assert mart.json("datasets", "merge", "both", "one", "two", "--allow", field)["changed"] == 2


def test_edits_are_told_and_change_the_digest(mart: Mart, paths: list[Path]) -> None:
    before = mart.json("datasets", "create", "few", *paths)["sha256"]
    mart("episodes", "edit", paths[0], "--cut", "0-4")
    assert mart.json("datasets", "list")["datasets"][0]["sha256"] != before
    assert "6 of 10 ticks, 1 segment" in mart("datasets", "show", "few")
    mart("episodes", "edit", paths[0], "--undo")
    assert mart.json("datasets", "list")["datasets"][0]["sha256"] == before
