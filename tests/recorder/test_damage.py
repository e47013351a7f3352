"""Files cut off and flipped at random: what is read is what was written or an error, and nothing else is touched.

A few dozen in every run; as many as wanted by hand, with the seed that is printed where one fails:

    DAMAGED_FILES=5000 .venv/bin/pytest tests/recorder/test_damage.py
"""

from __future__ import annotations

import contextlib
import os
import random
import resource
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from mart.episodes import labels
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.vocabulary import Verdict
from mart.recorder.catalogue.episode_catalogue import FILE_NAME, list_folder
from mart.recorder.repair.repair import RepairResult, repair_paths
from tests.recorder import synthetic
from tests.recorder.files import by_toy_replica, write_episode, write_part

_COUNT = int(os.environ.get("DAMAGED_FILES", "60"))
_WARM_UP = 50
_MAX_GROWTH_KB = 30_000
_TICKS = 30
_MEASURED = {"ticks", "first_tick", "last_tick", "started_ns", "ended_ns", "complete", "repaired", "arms"}

Damage = Callable[[random.Random, bytes], bytes]


def cut(chance: random.Random, data: bytes) -> bytes:
    return data[: chance.randrange(len(data))]


def flipped(chance: random.Random, data: bytes) -> bytes:
    at = chance.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]


def flipped_near_the_end(chance: random.Random, data: bytes) -> bytes:
    """Where metadata, indexes and the summary are."""
    at = len(data) - 1 - chance.randrange(min(len(data), 8000))
    return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]


def overwritten(chance: random.Random, data: bytes) -> bytes:
    at, size = chance.randrange(len(data)), chance.choice([2, 16, 512, 4096])
    filling = bytes(size) if chance.random() < 0.5 else chance.randbytes(size)
    return (data[:at] + filling + data[at + size :])[: len(data)]


def without_a_piece(chance: random.Random, data: bytes) -> bytes:
    at = chance.randrange(len(data))
    return data[:at] + data[at + chance.choice([1, 8, 512]) :]


DAMAGES: tuple[Damage, ...] = (cut, flipped, flipped, flipped_near_the_end, overwritten, without_a_piece)


class Written:
    """An episode file, a leftover of the same episode, and what is in them."""

    def __init__(self, root: Path) -> None:
        self.path = write_episode(root / "finished", _TICKS).path
        self.data = self.path.read_bytes()
        part, _, _ = write_part(root / "part", synthetic.states(_TICKS))
        part.flush()
        part.abandon()
        self.left = part.path.read_bytes()
        file = EpisodeFile.open(self.path)
        self.metadata: Mapping[str, Mapping[str, str]] = file.metadata
        self.episode = file.episode
        self.states = [state.SerializeToString() for state in file.states()]
        self.messages = {(message.topic, message.payload) for message in file.messages()}


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    return Written(tmp_path_factory.mktemp("written"))


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_nothing_wrong_is_read_and_nothing_else_is_touched(
    written: Written, tmp_path_factory: pytest.TempPathFactory
) -> None:
    warm_kb = 0
    root = tmp_path_factory.mktemp("damaged")
    good = write_episode(root, 5, number=2).path
    before = good.read_bytes(), os.stat(good).st_mtime_ns
    for seed in range(_COUNT):
        chance = random.Random(seed)
        is_part = chance.random() < 0.3
        damaged = good.with_name(f"damaged.mcap{'.part' * is_part}")
        data = chance.choice(DAMAGES)(chance, written.left if is_part else written.data)
        damaged.write_bytes(data)
        try:
            judge(root, damaged, data, good, written)
            assert (good.read_bytes(), os.stat(good).st_mtime_ns) == before
        except BaseException:
            print(f"seed {seed}, kept as {damaged}")
            raise
        for path in root.rglob("*"):
            if path.is_file() and path != good:
                path.unlink()
        used_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        warm_kb = warm_kb if seed > _WARM_UP else used_kb
        assert used_kb - warm_kb < _MAX_GROWTH_KB, seed


def judge(root: Path, damaged: Path, data: bytes, good: Path, written: Written) -> None:
    if damaged.suffix == ".mcap":
        read_right(damaged, written)
    rows = {row.file_path.name: row for row in list_folder(root)}
    assert rows[good.name].error is None
    results = list(repair_paths([root], by_toy_replica))
    if damaged.suffix == ".mcap":
        assert damaged.read_bytes() == data
    for result in results:
        assert result.source == damaged
        if result.saved is not None:
            mended_right(result, written)
    names = {path.name for path in root.rglob("*") if path.is_file()}
    expected = {good.name, damaged.name, FILE_NAME, labels.FILE_NAME, "damaged.mcap.unreadable"}
    expected |= {result.saved.path.name for result in results if result.saved}
    assert names <= expected


def read_right(path: Path, written: Written) -> None:
    """Whatever is asked of a finished file is what was written, or an error."""
    with contextlib.suppress(Corrupt, NotFound):
        file = EpisodeFile.open(path)
        assert file.metadata == written.metadata
        assert file.model() == synthetic.MJB
    found: list[bytes] = []
    try:
        found.extend(state.SerializeToString() for state in EpisodeFile(path, {}).states())
        assert found == written.states
    except Corrupt:
        assert set(found) <= set(written.states)


def mended_right(result: RepairResult, written: Written) -> None:
    """Nothing is invented: every message was there, and every record says what was so, or that it is not known."""
    assert result.saved is not None
    file = EpisodeFile.open(result.saved.path)
    file.check()
    assert {(message.topic, message.payload) for message in file.messages()} <= written.messages
    assert file.verification.verdict is not Verdict.DIVERGED
    known, found = written.episode.model_dump(), file.episode.model_dump()
    for name in known.keys() - _MEASURED:
        assert found[name] in (known[name], None, "unspecified") or name in ("reason", "interrupted"), name
    assert found["reason"] in (known["reason"], "the recording was cut short")
    assert found["ticks"] <= known["ticks"]
    assert found["first_tick"] >= known["first_tick"]
    assert not found["complete"] or found["ticks"] == known["ticks"]
    room = written.metadata["mart.room"]
    assert all(room[name] == text for name, text in file.metadata["mart.room"].items())
    with contextlib.suppress(NotFound):
        assert file.model() == synthetic.MJB
