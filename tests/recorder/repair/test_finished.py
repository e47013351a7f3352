"""A finished file that is damaged is mended into a new one beside it; what is not MART's is named and never touched."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from mcap.opcode import Opcode

from mart.episodes import labels
from mart.episodes.folder import list_episodes
from mart.episodes.labels import LabelKind
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, recording
from mart.protocol.errors import NotFound
from mart.protocol.messages import State
from mart.recorder.repair.repair import RepairResult, repair_all, repair_paths
from tests.episodes.rewritten import LAYOUTS, hostile_files
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode

_TICKS = 40


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write_episode(tmp_path, _TICKS).path


def places(data: bytes) -> list[tuple[int, int]]:
    """(where a record begins, its opcode)."""
    found, at = [], 8
    while at < len(data) - 8:
        found.append((at, data[at]))
        at += 9 + int.from_bytes(data[at + 1 : at + 9], "little")
    return found


def spoil(path: Path, at: int, bit: int = 0x10) -> None:
    data = bytearray(path.read_bytes())
    data[at] ^= bit
    path.write_bytes(data)


def chunks(path: Path) -> list[int]:
    return [at for at, opcode in places(path.read_bytes()) if opcode == Opcode.CHUNK]


def repaired(*paths: Path) -> list[RepairResult]:
    return list(repair_paths(paths, by_toy_replica))


def ticks(path: Path) -> list[int]:
    return [codec.decode(State, m.payload).tick for m in EpisodeFile.open(path).messages(recording.STATE)]


def test_what_stands_beside_a_broken_chunk_is_saved_into_a_new_file(path: Path) -> None:
    spoil(path, chunks(path)[3] + 200)
    before = path.read_bytes()
    (one,) = repaired(path)
    assert one.saved is not None
    assert one.saved.path == path.with_name(f"{path.stem}.repaired.mcap")
    assert path.read_bytes() == before
    file = EpisodeFile.open(one.saved.path)
    file.check()
    kept = ticks(one.saved.path)
    assert set(range(_TICKS + 1)) - set(kept) == set(range(11, 16))
    assert (file.episode.repaired, file.episode.complete, file.cadence.missing_ticks) == (True, False, 5)
    assert "1 damaged places" in one.detail
    whole = 6 * (_TICKS + 1) + 2  # of each tick six, and two events
    assert f"{whole - 6 * 5} of {whole} messages kept" in one.detail
    assert file.model() == synthetic.MJB


def test_the_first_chunk_takes_nothing_else_along(path: Path) -> None:
    """The end of the file describes the channels too, and the records say what the first event said."""
    recorded = EpisodeFile.open(path)
    spoil(path, chunks(path)[0] + 200)
    (one,) = repaired(path)
    assert one.saved is not None
    file = EpisodeFile.open(one.saved.path)
    assert ticks(one.saved.path) == list(range(1, _TICKS + 1))
    for name in ("room", "number", "task", "control_hz", "seed", "mode", "outcome", "reason"):
        assert getattr(file.episode, name) == getattr(recorded.episode, name), name
    assert file.operators == recorded.operators
    assert not file.episode.complete


def test_a_leftover_with_its_end_keeps_what_follows_the_first_chunk(path: Path) -> None:
    spoil(path, chunks(path)[0] + 200)
    part = path.rename(path.with_name(f"{path.name}.part"))
    (one,) = repair_all(path.parent.parent, by_toy_replica)
    assert one.saved is not None
    assert not part.exists()
    assert ticks(one.saved.path) == list(range(1, _TICKS + 1))


def test_a_file_that_was_cut_off_is_saved_as_far_as_it_goes(path: Path) -> None:
    cut = chunks(path)[5] + 30
    path.write_bytes(path.read_bytes()[:cut])
    (one,) = repaired(path)
    assert one.saved is not None
    assert ticks(one.saved.path) == list(range(21))
    assert not one.saved.episode.complete


def test_a_record_that_nothing_vouches_for_any_more_is_not_believed(path: Path) -> None:
    data = path.read_bytes()
    spoil(path, data.rindex(b"the task is done", 0, data.rindex(b"mart.operators")), 1)
    (one,) = repaired(path)
    assert one.saved is not None
    assert one.saved.episode.reason == "the task is done"  # as its event says
    assert ticks(one.saved.path) == list(range(_TICKS + 1))


def test_what_people_said_holds_for_the_new_file_and_the_old_counts_no_more(path: Path) -> None:
    root = path.parent.parent
    labels.say(path, LabelKind.OUTCOME, "failure", 1)
    labels.say(path, LabelKind.NOTE, "slipped", 2)
    labels.say(path, LabelKind.JOIN, "few", 3)
    spoil(path, chunks(path)[3] + 200)
    repaired(root)
    rows = {row.file_path.name: row for row in list_episodes(root)}
    new = rows[f"{path.stem}.repaired.mcap"]
    assert (new.outcome, new.note, new.datasets, new.dropped) == ("failure", "slipped", ("few",), False)
    assert rows[path.name].dropped


def test_a_folder_is_repaired_once_and_whole_files_stay_as_they_are(path: Path) -> None:
    root = path.parent.parent
    whole = write_episode(root, 5, number=2).path
    before = whole.read_bytes(), whole.stat().st_mtime_ns
    spoil(path, chunks(path)[3] + 200)
    assert [one.source for one in repaired(root)] == [path]
    (again,) = repaired(root)
    assert (again.saved, again.needless) == (None, True)
    assert (whole.read_bytes(), whole.stat().st_mtime_ns) == before
    (named,) = repaired(whole)
    assert (named.saved, named.needless) == (None, True)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_what_another_tool_has_rewritten_is_whole(layout: str, path: Path, tmp_path: Path) -> None:
    other = LAYOUTS[layout](path, tmp_path / "other.mcap")
    (one,) = repaired(other)
    assert (one.saved, one.needless) == (None, True)


FOREIGN = {
    "pointer.mcap": b"version https://git-lfs.github.com/spec/v1\n",
    "table.mcap": b"PAR1" + bytes(50),
    "real.mcap.part": b"\x89HDF\r\n\x1a\n" + bytes(50),
    "empty.mcap": b"",
    "ros.mcap": b"\x89MCAP0\r\n\x01\x0c\0\0\0\0\0\0\0\x04\0\0\0ros2\0\0\0\0" + bytes(20),
    "ros.mcap.part": b"\x89MCAP0\r\n\x01\x0c\0\0\0\0\0\0\0\x04\0\0\0ros2\0\0\0\0" + bytes(20),
}


def test_what_is_not_ours_is_named_and_never_touched(path: Path) -> None:
    root, day = path.parent.parent, path.parent
    for name, data in FOREIGN.items():
        (day / name).write_bytes(data)
    (day / "folder.mcap").mkdir()
    (day / "folder.mcap.part").mkdir()
    (day / "dangling.mcap").symlink_to("nowhere")
    (day / "dangling.mcap.part").symlink_to("nowhere")
    os.mkfifo(day / "pipe.mcap.part")
    spoil(path, chunks(path)[3] + 200)
    before = {file.name: os.lstat(file) for file in day.iterdir()}
    done = repaired(root)
    assert [one.source for one in done if one.saved] == [path]
    assert {one.source.name for one in done} >= FOREIGN.keys()
    after = {file.name: os.lstat(file) for file in day.iterdir()}
    assert after.keys() - before.keys() == {f"{path.stem}.repaired.mcap"}
    assert {name: (after[name].st_ino, after[name].st_size) for name in before} == {
        name: (found.st_ino, found.st_size) for name, found in before.items()
    }
    for name in FOREIGN:
        (one,) = repaired(day / name)
        assert one.saved is None
        assert "left alone" in one.detail


def test_one_bad_file_never_stops_the_others(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    root = path.parent.parent
    paths = [write_episode(root, 20, number=number).path for number in (2, 3)]
    parts = [one.rename(one.with_name(f"{one.name}.part")) for one in (path, *paths)]
    real = EpisodeFile.open.__func__  # type: ignore[attr-defined]

    def failing(cls: type[EpisodeFile], opened: Path) -> EpisodeFile:
        if opened == parts[0]:
            raise ZeroDivisionError("a mistake")
        return real(cls, opened)

    monkeypatch.setattr(EpisodeFile, "open", classmethod(failing))
    done = {one.source: one for one in repair_all(root, by_toy_replica)}
    assert done[parts[0]].saved is None
    assert "a mistake" in done[parts[0]].detail
    assert parts[0].exists()
    assert all(done[part].saved is not None for part in parts[1:])


def test_a_name_that_is_taken_meanwhile_is_not_overwritten(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = path.parent.parent
    part = path.rename(path.with_name(f"{path.name}.part"))
    spoil(part, chunks(part)[3] + 200)
    path.write_bytes(b"somebody else's")
    first = [path]

    def unaware(target: Path) -> bool:
        if target in first:
            first.clear()
            return False
        return os.path.lexists(target)

    monkeypatch.setattr("mart.recorder.record.finalize._taken", unaware)
    (one,) = repair_all(root, by_toy_replica)
    assert one.saved is not None
    assert path.read_bytes() == b"somebody else's"
    assert one.saved.path.name == f"{path.stem}-2.mcap"


def test_a_file_that_was_being_named_is_not_doubled(path: Path) -> None:
    part = path.with_name(f"{path.name}.part")
    os.link(path, part)  # as a power cut between the two steps of naming leaves it
    assert list(repair_all(path.parent.parent, by_toy_replica)) == []
    assert not part.exists()
    assert path.exists()


def test_hostile_files_are_told_and_cost_nothing(tmp_path: Path) -> None:
    files = list(hostile_files(tmp_path))
    done = repaired(*files)
    assert [one.saved for one in done] == [None] * len(files)
    assert sorted(tmp_path.iterdir()) == sorted(files)


def test_two_episodes_in_one_file_do_not_become_one(path: Path) -> None:
    other = write_episode(path.parent.parent, 10, number=2).path
    data = path.read_bytes()
    end = next(at for at, opcode in places(data) if opcode == Opcode.DATA_END)
    merged = path.with_name("merged.mcap")
    inside = other.read_bytes()
    first = next(at for at, opcode in places(inside) if opcode == Opcode.CHUNK)
    merged.write_bytes(data[:end] + inside[first:])
    (one,) = repaired(merged)
    assert one.saved is not None
    assert one.saved.episode.ticks == _TICKS
    assert "of another episode" in one.detail


def test_no_path_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        repaired(tmp_path / "none.mcap")


def test_the_sample_of_a_cut_file(path: Path) -> None:
    copy = shutil.copy(path, path.with_name("a copy.mcap"))
    Path(copy).write_bytes(path.read_bytes()[:2000])
    (one,) = repaired(Path(copy))
    assert one.saved is None
    assert "no intact state" in one.detail
