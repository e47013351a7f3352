"""The catalogue is derived: whatever happens to it, it says again what the files say."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.episodes import labels
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.labels import LabelKind
from mart.recorder.catalogue import episode_catalogue
from mart.recorder.catalogue.episode_catalogue import list_folder
from tests.recorder import synthetic
from tests.recorder.files import write_episode


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for number in (1, 2, 3):
        write_episode(tmp_path, ticks=10, number=number)
    return tmp_path


def numbers(rows: list[LabelledEpisode]) -> list[int]:
    return [row.number for row in rows]


def test_a_row_says_what_the_file_says(root: Path) -> None:
    row = list_folder(root)[0]
    assert row.path == f"2026-09-21/room-1-0001-{synthetic.TASK}.mcap"
    assert (row.task, row.outcome, row.verdict, row.verified) == (synthetic.TASK, "success", "verified", True)
    assert (row.ticks, row.complete, row.missing_ticks) == (10, True, 0)
    assert row.operators == {"arm0": "human Ana", "arm1": "hold"}
    assert row.real_time_factor == pytest.approx(1.0)


def test_deleted_it_is_derived_anew(root: Path) -> None:
    before = list_folder(root)
    (root / episode_catalogue.FILE_NAME).unlink()
    assert list_folder(root) == before


@pytest.mark.parametrize("data", [b"", b"this is no database" * 100], ids=["empty", "garbage"])
def test_damaged_it_is_derived_anew(root: Path, data: bytes) -> None:
    before = list_folder(root)
    (root / episode_catalogue.FILE_NAME).write_bytes(data)
    assert list_folder(root) == before


def test_it_follows_the_folder(root: Path) -> None:
    list_folder(root)
    write_episode(root, ticks=10, number=4)
    next(root.rglob("*0002*")).unlink()
    assert numbers(list_folder(root)) == [1, 3, 4]


def test_it_reads_only_what_has_changed(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    list_folder(root)
    monkeypatch.setattr(episode_catalogue, "describe", lambda *_: pytest.fail("read again"))
    assert len(list_folder(root)) == 3


def test_labels_lie_over_the_rows(root: Path) -> None:
    path = next(root.rglob("*0002*"))
    labels.say(path, LabelKind.OUTCOME, "failure", 1)
    labels.say(path, LabelKind.USE, "drop", 2)
    labels.say(path, LabelKind.NOTE, "cube slipped", 3)
    row = list_folder(root)[1]
    assert (row.outcome, row.dropped, row.note) == ("failure", True, "cube slipped")


def test_a_file_that_cannot_be_read_is_listed_with_the_reason(root: Path) -> None:
    (root / "2026-09-21" / "broken.mcap").write_bytes(b"broken")
    broken = next(row for row in list_folder(root) if row.path.endswith("broken.mcap"))
    assert broken.error is not None
    assert "is no MCAP file" in broken.error
