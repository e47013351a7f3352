"""Reading files that nobody vouches for: one sentence about what is wrong, and no more memory than the file is long."""

from __future__ import annotations

import contextlib
import struct
from pathlib import Path

import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import Writer

from mart.episodes.folder import list_episodes
from mart.episodes.reader import EpisodeFile, open_episode
from mart.episodes.writer import EpisodeWriter
from mart.protocol import recording
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.recording import (
    CadenceRecord,
    EpisodeRecord,
    OperatorsRecord,
    RoomRecord,
    VerificationRecord,
)
from mart.protocol.vocabulary import Verdict
from tests.recorder import synthetic
from tests.recorder.files import write_episode


class Written:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.data = path.read_bytes()


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    return Written(write_episode(tmp_path_factory.mktemp("episodes")).path)


def read_all(path: Path) -> tuple[object, ...]:
    """Everything that a file can be asked for."""
    file = EpisodeFile.open(path)
    file.check()
    return file.episode, file.cadence, file.operators, file.verification, file.room, file.model()


def test_an_episode_reads_whole(written: Written) -> None:
    read_all(written.path)
    states = list(EpisodeFile.open(written.path).messages(recording.STATE))
    assert [message.sequence for message in states] == list(range(31))


@settings(max_examples=100)
@given(cut=st.integers(0, 10**6))
def test_a_cut_file_is_corrupt_and_nothing_worse(
    cut: int, written: Written, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("cut") / "cut.mcap"
    path.write_bytes(written.data[: cut % len(written.data)])
    with pytest.raises(Corrupt):
        read_all(path)


@settings(max_examples=150)
@given(where=st.integers(0, 10**6), spoilt=st.binary(min_size=1, max_size=12), from_end=st.booleans())
def test_a_spoilt_file_reads_or_is_corrupt(
    where: int, spoilt: bytes, from_end: bool, written: Written, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Half of the examples hit the summary, at the end, whose lengths and offsets are the dangerous ones."""
    at = len(written.data) - where % 3000 if from_end else where % len(written.data)
    path = tmp_path_factory.mktemp("spoilt") / "spoilt.mcap"
    path.write_bytes(written.data[:at] + spoilt + written.data[at + len(spoilt) :])
    with contextlib.suppress(Corrupt, NotFound):  # not found: the attachment's name was hit
        read_all(path)


def test_a_length_of_exabytes_asks_for_no_memory(written: Written, tmp_path: Path) -> None:
    path = tmp_path / "long.mcap"
    path.write_bytes(written.data[:8] + struct.pack("<BQ", 6, 2**62) + written.data[17:])
    with pytest.raises(Corrupt):
        list(EpisodeFile(path, {}).messages())


def test_a_chunk_that_unpacks_to_gigabytes_is_refused(tmp_path: Path) -> None:
    bomb = zstandard.compress(bytes(recording.MAX_CHUNK_BYTES + 1))
    body = (
        struct.pack("<QQQI", 0, 0, 1, 0)
        + struct.pack("<I", 4)
        + b"zstd"
        + struct.pack("<Q", len(bomb))
        + bomb
    )
    path = tmp_path / "bomb.mcap.part"
    path.write_bytes(b"\x89MCAP0\r\n" + struct.pack("<BQ", 6, len(body)) + body)
    with pytest.raises(Corrupt):
        list(EpisodeFile(path, {}).messages())


def test_an_mcap_file_of_another_kind_is_named(tmp_path: Path) -> None:
    path = tmp_path / "other.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2")
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(Corrupt, match="ros2"):
        EpisodeFile.open(path)


def of_another_version(path: Path, verdict: str) -> Path:
    """An episode file with a verdict that this version may not know."""
    record = EpisodeRecord(
        room="room-1", number=1, arms=("arm0",), started_ns=1, ended_ns=2, ticks=1, first_tick=0, last_tick=1,
        outcome="success", reason="", interrupted=False, complete=True,
    )  # fmt: skip
    file = EpisodeWriter(path)
    file.add_record(record.NAME, record.to_strings() | {"a_key_of_tomorrow": "1"})
    file.add_record(OperatorsRecord.NAME, {"arm0": "human Ana"})
    file.add_record(CadenceRecord.NAME, {"wall_s": "1", "sim_s": "1", "missing_ticks": "0", "waited_s": "0"})
    file.add_record(VerificationRecord.NAME, {"verdict": verdict, "detail": ""})
    file.add_record("mart.tomorrow", {"key": "value"})
    file.add_record(recording.VERSIONS, {"mart-episodes": "9.1.0"})
    file.finish()
    file.move_to(path)
    return path


def test_a_file_of_another_version_reads_as_far_as_it_is_understood(tmp_path: Path) -> None:
    file = open_episode(of_another_version(tmp_path / "new.mcap", "verified"))
    assert (file.episode.number, file.verification.verdict) == (1, Verdict.VERIFIED)
    assert file.metadata["mart.tomorrow"] == {"key": "value"}


def test_a_file_of_another_version_that_is_not_understood_is_one_sentence_and_the_list_goes_on(
    tmp_path: Path,
) -> None:
    path = of_another_version(tmp_path / "2026-09-21" / "new.mcap", "plausible")
    known = write_episode(tmp_path).path
    with pytest.raises(Corrupt, match=r"^\S+new\.mcap, written by version 9\.1\.0 .*\bverdict\b[^\n]*$"):
        _ = open_episode(path).verification
    listed = {one.file_path: one.error for one in list_episodes(tmp_path)}
    assert listed[known] is None
    assert "9.1.0" in (listed[path] or "")


def with_spoilt_model(path: Path) -> Path:
    """Flip one bit inside the model."""
    data = bytearray(path.read_bytes())
    data[data.index(synthetic.MJB) + 5000] ^= 4
    path.write_bytes(data)
    return path


def test_one_bit_of_the_model_is_enough_to_be_corrupt(tmp_path: Path) -> None:
    file = EpisodeFile.open(with_spoilt_model(write_episode(tmp_path).path))
    for read in (file.check, file.check_model, file.model):
        with pytest.raises(Corrupt):
            read()


def test_a_model_that_its_checksum_fits_but_not_its_sha256_is_corrupt(tmp_path: Path) -> None:
    room = RoomRecord(room="room-1", model_sha256="0" * 64)
    file = EpisodeWriter(tmp_path / "other.mcap")
    file.describe(room)
    file.attach_model(synthetic.MODEL, 0)
    file.finish()
    file.move_to(file.path)
    with pytest.raises(Corrupt):
        EpisodeFile.open(file.path).model()


@settings(max_examples=60)
@given(where=st.integers(0, 10**6), bit=st.integers(0, 7))
def test_one_bit_anywhere_is_found(
    where: int, bit: int, written: Written, tmp_path_factory: pytest.TempPathFactory
) -> None:
    data = bytearray(written.data)
    data[where % len(data)] ^= 1 << bit
    path = tmp_path_factory.mktemp("flipped") / "flipped.mcap"
    path.write_bytes(data)
    with pytest.raises(Corrupt):
        EpisodeFile(path, {}).check()


@pytest.mark.parametrize("what", [b"verdict", b"waited_s", b"/arm/arm0/command"], ids=bytes.decode)
def test_a_flipped_bit_outside_of_chunks_is_found(what: bytes, tmp_path: Path) -> None:
    path = write_episode(tmp_path).path
    data = bytearray(path.read_bytes())
    data[data.rindex(what)] ^= 1
    path.write_bytes(data)
    with pytest.raises(Corrupt):
        EpisodeFile(path, {}).check()


def test_a_room_is_described_once(tmp_path: Path) -> None:
    file = EpisodeWriter(tmp_path / "room.mcap")
    full = RoomRecord(room="room-1", task="t").with_numerics(synthetic.NUMERICS)
    for record in (full, RoomRecord(room="room-1", task="t")):
        file.describe(record)
    file.finish()
    file.move_to(file.path)
    assert EpisodeFile.open(file.path).room == full
    assert EpisodeFile.open(file.path).room.numerics == synthetic.NUMERICS


def test_no_file_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        EpisodeFile.open(tmp_path / "none.mcap")
