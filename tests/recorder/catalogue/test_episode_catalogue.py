"""The catalogue is derived: whatever happens to it, it says again what the files say."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from mart.episodes import labelled_episode, labels
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.labels import LabelKind
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol.recording import EpisodeRecord
from mart.recorder.catalogue import episode_catalogue
from mart.recorder.catalogue.episode_catalogue import list_folder, list_paths
from mart.recorder.catalogue.listing import episode_message
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


def test_torn_anywhere_it_is_derived_anew(root: Path) -> None:
    before = list_folder(root)
    path = root / episode_catalogue.FILE_NAME
    whole = path.read_bytes()
    for at in range(0, len(whole), 512):
        for torn in (
            whole[:at] + bytes(4096) + whole[at + 4096 :],
            whole[:at] + b"torn" + whole[at + 4 :],
            whole[:at],
        ):
            path.write_bytes(torn)
            assert list_folder(root) == before


def test_a_row_that_has_changed_is_not_believed(root: Path) -> None:
    before = list_folder(root)
    path = root / episode_catalogue.FILE_NAME
    path.write_bytes(path.read_bytes().replace(b'"outcome":"success"', b'"outcome":"failure"'))
    assert list_folder(root) == before


def test_a_journal_of_another_catalogue_is_swept_away(root: Path) -> None:
    before = list_folder(root)
    path = root / episode_catalogue.FILE_NAME
    path.write_bytes(path.read_bytes()[:4096])
    path.with_name(f"{path.name}-journal").write_bytes(b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7" + bytes(600))
    assert list_folder(root) == before


def test_a_folder_in_its_place_is_in_nobodys_way(root: Path) -> None:
    before = list_folder(root)
    (root / episode_catalogue.FILE_NAME).unlink()
    (root / episode_catalogue.FILE_NAME).mkdir()
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


ODD_NUMBERS = [
    {"number": str(2**70)},
    {"number": "1e3"},
    {"ticks": "-1"},
    {"ticks": "1" + "0" * 400},
    {"ticks": "1" + "0" * 5000},
    {"started_ns": "-1"},
    {"started_ns": str(2**70)},
    {"control_hz": "5e-324"},
    {"control_hz": "nan"},
    {"control_hz": "inf"},
    {"control_hz": "-20"},
    {"seed": "-1"},
    {"outcome": "splendid"},
    {"reason": "x" * 5000},
]


@pytest.mark.parametrize(
    "odd", ODD_NUMBERS, ids=lambda odd: "-".join(map(lambda part: part[:12], *odd.items()))
)
def test_a_number_that_cannot_be_is_a_row_that_says_so(odd: dict[str, str], root: Path) -> None:
    good = next(root.rglob("*0002*"))
    strings = dict(EpisodeFile.open(good).metadata)
    file = EpisodeWriter(good.with_name("odd.mcap"))
    for name, known in strings.items():
        file.add_record(name, {**known, **odd} if name == EpisodeRecord.NAME else known)
    file.finish()
    file.move_to(file.path)
    rows = {row.path.rpartition("/")[2]: row for row in list_folder(root)}
    assert EpisodeRecord.NAME in (rows["odd.mcap"].error or "")
    assert [row.number for row in rows.values() if row.error is None] == [1, 2, 3]
    for row in rows.values():
        episode_message(row).SerializeToString()


def test_an_odd_file_is_one_row_that_says_so(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    day = root / "2026-09-21"
    (day / "dangling.mcap").symlink_to("nowhere")
    (day / "loop.mcap").symlink_to("loop.mcap")
    (day / "folder.mcap").mkdir()
    os.mkfifo(day / "pipe.mcap")
    (day / "empty.mcap").touch()
    Path(os.fsdecode(bytes(day) + b"/caf\xe9.mcap")).touch()
    rows: list[LabelledEpisode] = []
    for _ in range(2):
        rows = list_folder(root)
        odd = [row for row in rows if row.error is not None]
        assert {row.path.rpartition("/")[2] for row in odd} == {
            "dangling.mcap", "loop.mcap", "folder.mcap", "pipe.mcap", "empty.mcap", "caf\ufffd.mcap",
        }  # fmt: skip
        assert len(rows) == len(odd) + 3
        for row in rows:
            episode_message(row).SerializeToString()
    listed = {row.file_path.name: row for row in list_paths([day])}
    assert "nowhere" in (listed["dangling.mcap"].error or "")
    assert len(listed) == len(rows)
    (day / "dangling.mcap").unlink()
    (day / "folder.mcap").rmdir()
    assert len(list_folder(root)) == len(rows) - 2


def test_a_file_that_goes_while_it_is_listed_is_left_out(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = labelled_episode.describe

    def deleting(path: Path, name: str) -> LabelledEpisode:
        path.unlink()
        return real(path, name)

    monkeypatch.setattr(episode_catalogue, "describe", deleting)
    assert list_folder(root) == []


def test_a_fault_of_ours_costs_one_row(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = EpisodeFile.open.__func__  # type: ignore[attr-defined]

    def failing(cls: type[EpisodeFile], path: Path) -> EpisodeFile:
        if "0002" in path.name:
            raise ZeroDivisionError("a mistake")
        return real(cls, path)

    monkeypatch.setattr(EpisodeFile, "open", classmethod(failing))
    assert ["a mistake" in (row.error or "") for row in list_folder(root)].count(True) == 1
    assert len(list_folder(root)) == 3
