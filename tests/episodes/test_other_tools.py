"""Files of other tools, and files that are none: read wherever the format allows it, or named in one sentence."""

from __future__ import annotations

import os
import shutil
import time
import tracemalloc
from collections import Counter
from pathlib import Path

import pytest
from mcap.writer import Writer

from mart.episodes.arrays import arrays_from_states
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol.errors import Corrupt, MartError, NotFound
from mart.protocol.recording import CHECKSUMS, MAX_METADATA_BYTES, RoomRecord
from tests.episodes.rewritten import LAYOUTS, by_writer, hostile_files
from tests.recorder import synthetic
from tests.recorder.files import write_episode


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_episode(tmp_path_factory.mktemp("source")).path


def contents(path: Path) -> Counter[tuple[object, ...]]:
    found = EpisodeFile.open(path).messages()
    return Counter((m.topic, m.payload, m.arrived_ns, m.sent_ns, m.sequence) for m in found)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_that_the_format_allows_reads_the_same(
    layout: str, source: Path, tmp_path: Path
) -> None:
    other = LAYOUTS[layout](source, tmp_path / "other.mcap")
    assert contents(other) == contents(source)
    one, same = EpisodeFile.open(other), EpisodeFile.open(source)
    assert one.metadata == same.metadata
    assert one.model() == synthetic.MJB
    states = list(one.states())
    assert [state.tick for state in states] == list(range(31))
    assert (arrays_from_states(states).actions == arrays_from_states(list(same.states())).actions).all()


def test_what_another_tool_has_added_is_shown_and_in_nobodys_way(source: Path, tmp_path: Path) -> None:
    with (tmp_path / "other.mcap").open("wb") as out:
        writer = Writer(out)
        writer.start(profile="mart")
        for name, strings in EpisodeFile.open(source).metadata.items():
            writer.add_metadata(name, dict(strings))
        writer.add_metadata("note", {"who": "Ana"})
        writer.add_metadata("note", {"who": "Ben"})
        writer.add_metadata("robot", {"description": "x" * MAX_METADATA_BYTES})
        writer.add_attachment(0, 0, "scene.jpg", "image/jpeg", b"jpeg")
        writer.finish()  # type: ignore[no-untyped-call]
    file = EpisodeFile.open(tmp_path / "other.mcap")
    assert file.episode == EpisodeFile.open(source).episode
    assert file.metadata["note"] == {"who": "Ben"}
    with pytest.raises(NotFound):
        file.model()


def test_the_last_word_about_a_room_holds(tmp_path: Path) -> None:
    file = EpisodeWriter(tmp_path / "room.mcap")
    for task in (None, "two_arm_multi_cube_lifting"):
        record = RoomRecord(room="room-1", task=task)
        file.add_record(record.NAME, record.to_strings())
    file.finish()
    file.move_to(file.path)
    assert EpisodeFile.open(file.path).room.task == "two_arm_multi_cube_lifting"


def test_two_episodes_in_one_file_are_refused(source: Path, tmp_path: Path) -> None:
    with (tmp_path / "merged.mcap").open("wb") as out:
        writer = Writer(out)
        writer.start(profile="mart")
        writer.add_metadata("mart.episode", {"number": "1"})
        writer.add_metadata("mart.episode", {"number": "2"})
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(Corrupt, match="as if of two episodes"):
        EpisodeFile.open(tmp_path / "merged.mcap")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b"success", b"succesr"),
        (synthetic.MJB[:40], b"\0" + synthetic.MJB[1:40][::-1]),
        (b"\x06number", b"\x06mumber"),
    ],
)
def test_what_no_chunk_protects_is_not_believed_when_it_has_changed(
    before: bytes, after: bytes, source: Path, tmp_path: Path
) -> None:
    data = source.read_bytes()
    at = data.rindex(before[1:] if before.startswith(b"\x06") else before)
    change = after[1:] if before.startswith(b"\x06") else after
    path = tmp_path / "changed.mcap"
    path.write_bytes(data[:at] + change + data[at + len(change) :])
    with pytest.raises(Corrupt):
        EpisodeFile.open(path).check()


def test_a_chunk_that_is_no_chunk_any_more_is_missed(source: Path, tmp_path: Path) -> None:
    data = bytearray(source.read_bytes())
    at = data.rindex(b"\x04\x00\x00\x00zstd", 0, data.index(b"mart.episode")) - 37
    assert data[at] == 6
    data[at] = 0x86  # another tool's own record, which readers pass over
    path = tmp_path / "passed-over.mcap"
    path.write_bytes(data)
    with pytest.raises(Corrupt, match="messages"):
        list(EpisodeFile.open(path).states())


def test_checksums_are_not_shown_and_files_without_them_read(source: Path, tmp_path: Path) -> None:
    assert CHECKSUMS not in EpisodeFile.open(source).metadata
    assert CHECKSUMS not in EpisodeFile.open(by_writer(source, tmp_path / "old.mcap")).metadata


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return list(hostile_files(tmp_path_factory.mktemp("hostile")))


@pytest.mark.slow
def test_a_small_file_costs_little_whatever_it_says(hostile: list[Path]) -> None:
    for path in hostile:
        tracemalloc.start()
        began_s = time.process_time()
        try:
            with pytest.raises(Corrupt):
                _ = EpisodeFile.open(path).episode
            with pytest.raises(Corrupt):
                EpisodeFile(path, {}).arrays()
            with pytest.raises(MartError):
                EpisodeFile(path, {}).model()
            _, peak_bytes = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        assert path.stat().st_size < 1_000_000
        assert peak_bytes < 5 * path.stat().st_size + 30_000_000, path
        assert time.process_time() - began_s < 5.0, path


FOREIGN = {
    b"": "is empty",
    b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n": "git lfs pull",
    b"\x89HDF\r\n\x1a\n" + bytes(100): "an HDF5 file",
    b"PAR1" + bytes(100): "a Parquet file",
    b"SQLite format 3\0" + bytes(100): "an SQLite database",
    b"#ROSBAG V2.0\n": "ROS 1",
    b"\x1f\x8b\x08" + bytes(100): "unpack it first",
    b"hello world": "is no MCAP file",
    b"\0": "is no MCAP file",
}


@pytest.mark.parametrize("data", FOREIGN)
@pytest.mark.parametrize("name", ["other.mcap", "other.hdf5"])
def test_what_is_no_episode_is_called_what_it_is(data: bytes, name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    with pytest.raises(Corrupt, match=FOREIGN[data]) as told:
        EpisodeFile.open(path)
    assert "damaged" not in str(told.value)
    assert "repair" not in str(told.value)
    assert "\n" not in str(told.value)


@pytest.fixture
def odd(tmp_path: Path, source: Path) -> Path:
    """A folder with one good file among odd ones."""
    shutil.copy(source, tmp_path / "good.mcap")
    (tmp_path / "dangling.mcap").symlink_to("nowhere")
    (tmp_path / "loop.mcap").symlink_to("loop.mcap")
    (tmp_path / "folder.mcap").mkdir()
    os.mkfifo(tmp_path / "pipe.mcap")
    (tmp_path / "empty.mcap").write_bytes(b"")
    return tmp_path


def test_an_odd_file_is_a_sentence(odd: Path) -> None:
    for path in odd.iterdir():
        if path.name != "good.mcap":
            with pytest.raises((Corrupt, NotFound)) as told:
                EpisodeFile.open(path)
            assert str(path) in str(told.value)
            assert "damaged" not in str(told.value)
