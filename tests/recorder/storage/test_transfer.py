"""What goes to a store comes back whole, with all that was said; nothing there or here is ever overwritten."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes import labels
from mart.episodes.labels import LabelKind
from tests.recorder.conftest import Mart
from tests.recorder.files import write_episode


@pytest.fixture
def url(tmp_path: Path) -> str:
    return f"file://{tmp_path / 'store'}"


def test_episodes_and_what_was_said_come_back(mart: Mart, path: Path, url: str, tmp_path: Path) -> None:
    labels.say(path, LabelKind.NOTE, "cube slipped", at_ns=5)
    out = tmp_path / "elsewhere"
    pushed = mart.json("episodes", "push", url)
    assert (len(pushed["files"]), pushed["labels"]) == (1, 1)
    again = mart.json("episodes", "push", mart.episodes_dir, url)
    assert (again["files"], again["there"], again["labels"]) == ([], 1, 0)
    pulled = mart.json("episodes", "pull", url, "--out", out)
    assert (len(pulled["files"]), pulled["labels"]) == (1, 1)
    assert (out / pulled["files"][0]).read_bytes() == path.read_bytes()
    assert labels.read(out) == labels.read(mart.episodes_dir)
    again = mart.json("episodes", "pull", url, "--out", out)
    assert (again["files"], again["there"], again["labels"]) == ([], 1, 0)


def test_what_two_people_said_is_put_together_by_its_time(
    mart: Mart, path: Path, url: str, tmp_path: Path
) -> None:
    mart.json("episodes", "push", url)
    out = tmp_path / "elsewhere"
    (name,) = mart.json("episodes", "pull", url, "--out", out)["files"]
    labels.say(path, LabelKind.NOTE, "older", at_ns=5)
    labels.say(out / name, LabelKind.NOTE, "newer", at_ns=6)
    mart.json("episodes", "push", url)
    mart.json("episodes", "pull", url, "--out", out)
    assert labels.read_folded(out)[name].note == "newer"
    mart.json("episodes", "push", out, url)
    mart.json("episodes", "pull", url, "--out", mart.episodes_dir)
    assert labels.read_folded(mart.episodes_dir)[name].note == "newer"
    assert len(labels.read(mart.episodes_dir)) == 2


def test_another_file_of_that_name_stays(mart: Mart, path: Path, url: str, tmp_path: Path) -> None:
    (name,) = mart.json("episodes", "push", url)["files"]
    there = tmp_path / "store" / name
    before = there.read_bytes()
    path.unlink()
    write_episode(mart.episodes_dir, ticks=12)
    said = mart("episodes", "push", url, code=1)
    assert name in said
    assert "differs" in said
    assert there.read_bytes() == before
    assert "differs" in mart("episodes", "pull", url, "--out", mart.episodes_dir, code=1)


def test_what_is_cut_off_in_the_store_gets_no_name(mart: Mart, path: Path, url: str, tmp_path: Path) -> None:
    (name,) = mart.json("episodes", "push", url)["files"]
    there = tmp_path / "store" / name
    there.write_bytes(there.read_bytes()[:-100])
    out = tmp_path / "elsewhere"
    assert "not whole" in mart("episodes", "pull", url, "--out", out, code=1)
    there.with_name(f"{there.name}.sha256").unlink()
    assert "cut off" in mart("episodes", "pull", url, "--out", out, code=1)
    assert not [one for one in out.rglob("*") if one.is_file()]


def test_a_link_leads_nothing_out_of_the_folder(mart: Mart, path: Path, url: str, tmp_path: Path) -> None:
    (name,) = mart.json("episodes", "push", url)["files"]
    out, outside = tmp_path / "elsewhere", tmp_path / "outside"
    out.mkdir()
    outside.mkdir()
    (out / Path(name).parent).symlink_to(outside)
    assert "leads out" in mart("episodes", "pull", url, "--out", out, code=1)
    assert not list(outside.iterdir())


def test_an_export_goes_over_whole(mart: Mart, url: str, tmp_path: Path) -> None:
    export = tmp_path / "lifting"
    (export / "data").mkdir(parents=True)
    (export / "data" / "chunk.parquet").write_bytes(b"rows" * 1000)
    assert mart.json("episodes", "push", export, url)["files"] == ["lifting/data/chunk.parquet"]
    mart.json("episodes", "pull", url, "--out", tmp_path / "out")
    assert (tmp_path / "out/lifting/data/chunk.parquet").read_bytes() == b"rows" * 1000


@pytest.mark.parametrize("wrong", ["nowhere", "s3://key:secret@bucket/folder", "nosuch://bucket/folder"])
def test_a_url_that_cannot_be_used_is_refused_without_its_secret(mart: Mart, path: Path, wrong: str) -> None:
    said = mart("episodes", "push", mart.episodes_dir, wrong, code=1)
    assert "secret" not in said
    assert "Traceback" not in said
