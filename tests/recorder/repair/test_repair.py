"""What a crash leaves is mended: every intact message is kept, wherever the file was cut or spoilt."""

from __future__ import annotations

import fcntl
import random
import tracemalloc
from collections import Counter
from functools import cached_property
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode

from mart.episodes.mcap_entries import video_entry
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec, recording
from mart.protocol.errors import NotFound, Unavailable
from mart.protocol.vocabulary import Verdict
from mart.recorder.repair.repair import RepairResult, repair_all
from mart.recorder.repair.salvage import Salvage, SalvagedMessage
from mart.recorder.verify.resimulation import nobody, verify
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode, write_part

_TICKS = 40


class Left:
    """What kill -9 leaves just before an episode would have been saved."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    @cached_property
    def records(self) -> list[tuple[int, int]]:
        """(where a record begins, its opcode)."""
        found, at = [], 8
        while at < len(self.data):
            found.append((at, self.data[at]))
            at += 9 + int.from_bytes(self.data[at + 1 : at + 9], "little")
        return found

    @cached_property
    def chunk_ends(self) -> list[int]:
        starts = [at for at, _ in self.records] + [len(self.data)]
        return [end for (_, op), end in zip(self.records, starts[1:], strict=True) if op == Opcode.CHUNK]


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> Left:
    file, _, _ = write_part(tmp_path_factory.mktemp("left"), synthetic.states(_TICKS))
    file.flush()
    file.abandon()
    return Left(file.path.read_bytes())


def leftover(root: Path, data: bytes) -> Path:
    part = root / "2026-09-21" / f"room-1-0001-{synthetic.TASK}.mcap.part"
    part.parent.mkdir(parents=True, exist_ok=True)
    part.write_bytes(data)
    return part


def repaired(root: Path) -> RepairResult:
    (one,) = repair_all(root, by_toy_replica)
    return one


def ticks(path: Path) -> list[int]:
    return [message.sequence for message in EpisodeFile.open(path).messages(recording.STATE)]


def test_nothing_is_lost_when_the_crash_came_after_the_last_flush(tmp_path: Path, left: Left) -> None:
    part = leftover(tmp_path, left.data)
    one = repaired(tmp_path)
    assert one.saved is not None
    assert not part.exists()
    file = EpisodeFile.open(one.saved.path)
    assert file.episode.repaired
    assert file.episode.complete
    assert file.episode.outcome == "success"
    assert file.episode.task == synthetic.TASK
    assert file.operators.to_strings() == {"arm0": "human Ana", "arm1": "hold"}
    assert file.verification.verdict is Verdict.VERIFIED
    assert file.model() == synthetic.MJB
    assert ticks(one.saved.path) == list(range(_TICKS + 1))


def test_a_model_with_a_spoilt_byte_is_left_out(tmp_path: Path, left: Left) -> None:
    at = left.data.index(synthetic.MJB)
    leftover(tmp_path, left.data[:at] + bytes([left.data[at] ^ 1]) + left.data[at + 1 :])
    one = repaired(tmp_path)
    assert one.saved is not None
    assert ticks(one.saved.path) == list(range(_TICKS + 1))
    with pytest.raises(NotFound):
        EpisodeFile.open(one.saved.path).model()


def test_a_finished_file_with_a_spoilt_model_is_not_called_complete(tmp_path: Path) -> None:
    path = write_episode(tmp_path).path
    data = bytearray(path.read_bytes())
    data[data.index(synthetic.MJB)] ^= 1
    path.with_name(f"{path.name}.part").write_bytes(data)
    path.unlink()
    one = repaired(tmp_path)
    assert one.saved is not None
    assert EpisodeFile.open(one.saved.path).episode.repaired


def test_a_state_of_another_version_costs_itself_only(tmp_path: Path) -> None:
    states = synthetic.states(10)
    states[4].arms[0].source = 77  # type: ignore[assignment]
    file, _, _ = write_part(tmp_path, states)
    file.flush()
    file.abandon()
    one = repaired(tmp_path)
    assert one.saved is not None
    assert ticks(one.saved.path) == [0, 1, 2, 3, 5, 6, 7, 8, 9, 10]
    assert "1 messages that cannot be read" in one.detail


def test_what_somebody_else_repairs_is_left_alone(tmp_path: Path, left: Left) -> None:
    part = leftover(tmp_path, left.data)
    with part.open("rb") as elsewhere:
        fcntl.flock(elsewhere, fcntl.LOCK_SH)
        assert list(repair_all(tmp_path, by_toy_replica)) == []
    assert repaired(tmp_path).saved is not None


def test_an_outcome_that_was_not_written_is_that_of_the_last_state(tmp_path: Path) -> None:
    states = synthetic.states(5)
    states[-1].progress.success = True
    file, _, _ = write_part(tmp_path, states, is_over=False)
    file.flush()
    file.abandon()
    one = repaired(tmp_path)
    assert one.saved is not None
    record = EpisodeFile.open(one.saved.path).episode
    assert (record.outcome, record.complete, record.repaired) == ("success", True, True)


def test_a_repaired_file_holds_what_an_undisturbed_one_holds(tmp_path: Path, left: Left) -> None:
    leftover(tmp_path / "a", left.data)
    one = repaired(tmp_path / "a")
    undisturbed = write_episode(tmp_path / "b", _TICKS)
    assert one.saved is not None

    def contents(path: Path) -> Counter[tuple[object, ...]]:
        return Counter(
            (m.topic, m.payload, m.arrived_ns, m.sent_ns, m.sequence)
            for m in EpisodeFile.open(path).messages()
        )

    assert contents(one.saved.path) == contents(undisturbed.path)


@pytest.mark.slow
@settings(max_examples=60)
@given(where=st.integers(0, 10**6), beside=st.none() | st.sampled_from([-1, 0, 1, 5, 9, 30]))
def test_a_cut_anywhere_keeps_every_whole_chunk(
    where: int,
    beside: int | None,
    left: Left,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    """Anywhere, and beside the beginnings of records, where the classes of bytes change."""
    cut = (
        where % (len(left.data) + 1)
        if beside is None
        else left.records[where % len(left.records)][0] + beside
    )
    root = tmp_path_factory.mktemp("cut")
    part = leftover(root, left.data[:cut])
    one = repaired(root)
    chunks = sum(end <= cut for end in left.chunk_ends)
    expected = min(5 * chunks - 4, _TICKS + 1) if chunks else 0  # one chunk every five ticks
    if expected == 0:
        assert one.saved is None
        assert not part.exists()
        assert (root / part.parent / part.name.replace(".part", ".unreadable")).read_bytes() == left.data[
            :cut
        ]
    else:
        assert one.saved is not None
        assert ticks(one.saved.path) == list(range(expected))
        record = EpisodeFile.open(one.saved.path).episode
        assert record.repaired
        assert record.complete == (record.outcome == "success")


@pytest.mark.slow
@settings(max_examples=80)
@given(where=st.integers(0, 10**6), spoilt=st.binary(min_size=1, max_size=20))
@example(where=26, spoilt=b"\x00\x00\x00\x00\x00\x02")  # an index whose first byte says footer
@example(where=103, spoilt=b"\x00\x00\x10")  # how many entries an index has, in its content
@example(where=240, spoilt=b"\x00\x00\x00\x00\x9d")  # how much a chunk unpacks to: 10 MB
def test_spoilt_bytes_cost_the_chunks_they_are_in(
    where: int,
    spoilt: bytes,
    left: Left,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    first_chunk_end = left.chunk_ends[0]  # which describes the channels
    at = first_chunk_end + where % (len(left.data) - first_chunk_end)
    path = tmp_path_factory.mktemp("spoilt") / "spoilt.mcap.part"
    path.write_bytes((left.data[:at] + spoilt + left.data[at + len(spoilt) :])[: len(left.data)])
    found = [
        f for f in Salvage(path).found() if isinstance(f, SalvagedMessage) and f.topic == recording.STATE
    ]
    original = {codec.encode(state) for state in synthetic.states(_TICKS)}
    assert {f.payload for f in found} <= original
    assert len(found) >= _TICKS + 1 - 5 * 2  # twenty bytes may touch two chunks


@settings(max_examples=60)
@given(garbage=st.binary(max_size=300), begins_as_ours=st.booleans())
@example(garbage=b"", begins_as_ours=False)
def test_garbage_is_refused_and_kept(
    garbage: bytes, begins_as_ours: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """What a crash may have left is set aside, so that it is looked at once; what is not ours keeps its name."""
    root = tmp_path_factory.mktemp("garbage")
    magic = b"\x89MCAP0\r\n"
    data = magic + garbage if begins_as_ours else garbage
    part = leftover(root, data)
    one = repaired(root)
    assert one.saved is None
    ours = begins_as_ours or magic.startswith(garbage)  # a crash may come before the first bytes are whole
    kept = part.with_name(part.name.replace(".part", ".unreadable")) if ours else part
    assert kept.read_bytes() == data
    assert list(kept.parent.iterdir()) == [kept]


def test_a_file_that_only_lacked_its_name_is_given_it(tmp_path: Path) -> None:
    saved = write_episode(tmp_path)
    before = saved.path.read_bytes()
    saved.path.rename(saved.path.with_name(saved.path.name + ".part"))
    one = repaired(tmp_path)
    assert one.saved is not None
    assert one.saved.path == saved.path
    assert saved.path.read_bytes() == before
    assert not EpisodeFile.open(saved.path).episode.repaired


def test_a_file_that_is_being_written_is_left_alone(tmp_path: Path) -> None:
    file, _, _ = write_part(tmp_path, synthetic.states(5))
    file.flush()
    assert list(repair_all(tmp_path, by_toy_replica)) == []
    assert file.path.exists()
    file.abandon()
    assert repaired(tmp_path).saved is not None


def test_what_an_interrupted_repair_left_is_swept_up(tmp_path: Path, left: Left) -> None:
    part = leftover(tmp_path, left.data)
    part.with_name(part.name.replace(".part", ".mending")).write_bytes(b"half")
    assert repaired(tmp_path).saved is not None
    assert [path.suffix for path in tmp_path.rglob("*") if path.is_file()] == [".mcap"]


def test_an_episode_that_exists_is_never_overwritten(tmp_path: Path, left: Left) -> None:
    first = write_episode(tmp_path)
    before = first.path.read_bytes()
    leftover(tmp_path, left.data)
    one = repaired(tmp_path)
    assert one.saved is not None
    assert one.saved.path.name == f"room-1-0001-{synthetic.TASK}-2.mcap"
    assert first.path.read_bytes() == before


def test_without_a_replica_it_is_saved_unverified(tmp_path: Path, left: Left) -> None:
    leftover(tmp_path, left.data)
    ask = nobody(Unavailable("No replica is up."))
    (one,) = repair_all(tmp_path, lambda file, room: verify(file, room, ask))
    assert one.saved is not None
    assert one.saved.verification.verdict is Verdict.UNVERIFIED
    assert one.saved.verification.detail == "No replica is up."


def test_memory_stays_at_a_chunk_whatever_the_file(tmp_path: Path) -> None:
    file, _, _ = write_part(tmp_path, synthetic.states(5))
    noise = random.Random(0)
    for frame in range(150):
        video = synthetic.video(frame, is_key=False, data=noise.randbytes(100_000))
        file.add(video_entry("front", video, codec.encode(video), synthetic.wall_ns(frame)))
    file.flush()
    file.abandon()
    tracemalloc.start()
    try:
        kept = sum(1 for _ in Salvage(file.path).found())
        _, peak_bytes = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert kept > 150
    assert file.path.stat().st_size > 15_000_000
    assert peak_bytes < 5_000_000
