"""Complete a file: verify while it is still a `.part`, write what is known, read it back, and only then name it."""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import distributions
from pathlib import Path
from types import MappingProxyType

from mart.episodes import find_episodes
from mart.episodes.patient_file import patiently
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import clock
from mart.protocol.messages import Model
from mart.protocol.recording import (
    PART_SUFFIX,
    SUFFIX,
    VERSIONS,
    CadenceRecord,
    EpisodeRecord,
    OperatorsRecord,
    RoomRecord,
    VerificationRecord,
)
from mart.protocol.vocabulary import EpisodeOutcome
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.room_facts import RoomFacts

VerifyFile = Callable[[EpisodeFile, RoomRecord], VerificationRecord]
NameFile = Callable[[EpisodeWriter, EpisodeRecord], None]  # raises FileExistsError, and never overwrites

_PATIENCE_S = 20.0  # with a full disk; who stops the recorder waits for 30 s
_SLACK_NS = 1_000_000_000
_LAST_DAY_S = 253402300799  # of the year 9999: a file's stamps are only what its bytes say
_SAFE = re.compile(r"[a-z0-9][a-z0-9_-]*")
_FOUND = ("arms", "started_ns", "ended_ns", "ticks", "first_tick", "last_tick", "repaired")
_WRITES = ("mcap", "protobuf", "zstandard")  # besides MART's own parts


@dataclass(frozen=True)
class SavedEpisode:
    """Tell of an episode file that has its name."""

    path: Path
    episode: EpisodeRecord
    cadence: CadenceRecord
    verification: VerificationRecord
    size_bytes: int


@dataclass(frozen=True)
class RecordedFacts:
    """Hold what a damaged file itself still says of its episode; None where that is lost, or nothing vouches for it."""

    episode: EpisodeRecord | None = None
    operators: OperatorsRecord | None = None


def finalize(
    file: EpisodeWriter,
    episode: EpisodeAccumulator,
    facts: RoomFacts,
    root: Path,
    verify: VerifyFile,
    *,
    repaired: bool,
) -> SavedEpisode:
    """Complete `file` and move it to its name under `root`. repaired: whether a crash had left it.

    Raises OSError where the disk is full and Corrupt where what was written does not read back; the `.part` stays.
    """
    patience_s = 0.0 if repaired else _PATIENCE_S  # what a crash had left can wait for the next time
    name = below(root, patience_s)
    return complete(file, episode, facts, name, verify, repaired=repaired, patience_s=patience_s)


def complete(
    file: EpisodeWriter,
    episode: EpisodeAccumulator,
    facts: RoomFacts,
    name: NameFile,
    verify: VerifyFile,
    *,
    repaired: bool,
    recorded: RecordedFacts = RecordedFacts(),
    patience_s: float = 0.0,
) -> SavedEpisode:
    """Complete `file` and give it its name, as `finalize`.

    recorded: what an earlier file said of the episode. patience_s: for how long each step waits for room on the disk.
    """
    file.describe(facts.record())
    patiently(file.flush, patience_s)
    verification = verify(EpisodeFile(file.path, {}), facts.record())
    record, cadence = _as_recorded(recorded.episode, episode.record(facts, repaired)), episode.cadence()
    for known in (record, cadence, recorded.operators or episode.operators(facts), verification):
        file.add_record(known.NAME, known.to_strings())
    file.add_record(VERSIONS, versions())
    patiently(file.finish, patience_s)
    EpisodeFile(file.path, {}).check(file.messages)
    name(file, record)
    return SavedEpisode(file.path, record, cadence, verification, file.path.stat().st_size)


def is_saved(root: Path, room: str, number: int, at_ns: int) -> bool:
    """Tell whether a finished file with an outcome holds this moment (Unix time) of an episode.

    A recorder that was started anew hears again what a room said before.
    """
    for found in find_episodes(root, room, number):
        if found.error is None:
            record = EpisodeFile.open(found.file_path).episode
            is_of_it = record.started_ns - _SLACK_NS <= at_ns <= record.ended_ns + _SLACK_NS
            if is_of_it and record.outcome != EpisodeOutcome.UNSPECIFIED:
                return True
    return False


def below(root: Path, patience_s: float = 0.0) -> NameFile:
    """Return what moves a finished file to its name under `root`, which nothing had before."""

    def name(file: EpisodeWriter, record: EpisodeRecord) -> None:
        while True:
            path = free_path(root, record)
            try:
                return patiently(functools.partial(file.move_to, path), patience_s)
            except FileExistsError:  # another has taken the name meanwhile
                if not _taken(path):
                    raise

    return name


def _taken(path: Path) -> bool:
    """Tell whether anything has this name, a link that leads nowhere too."""
    return os.path.lexists(path)


def _as_recorded(recorded: EpisodeRecord | None, found: EpisodeRecord) -> EpisodeRecord:
    """Return what was recorded of an episode, with what is found of it now."""
    if recorded is None or (recorded.room, recorded.number) != (found.room, found.number):
        return found
    changes = {name: getattr(found, name) for name in _FOUND}
    is_complete = found.complete or (recorded.complete and recorded.ticks == found.ticks)
    return recorded.model_copy(update=changes | {"complete": is_complete})


def part_path(root: Path, episode: EpisodeAccumulator, facts: RoomFacts) -> Path:
    """Return where to write an episode that begins; nothing is there yet."""
    return free_path(root, episode.record(facts), PART_SUFFIX)


def free_path(root: Path, record: EpisodeRecord, suffix: str = SUFFIX) -> Path:
    """Return `{date}/{room}-{number}-{task}`; an episode in several files, cut by a restart, goes on with -2, -3, …"""
    day = datetime.fromtimestamp(min(record.started_ns / 1e9, _LAST_DAY_S), UTC).strftime("%Y-%m-%d")
    room = record.room if _SAFE.fullmatch(record.room) else "room"
    stem = f"{room}-{record.number:04}-{record.task or 'unknown'}"
    count = 1
    while True:
        path = root / day / f"{stem}{'' if count == 1 else f'-{count}'}{suffix}"
        if not _taken(path):
            return path
        count += 1


@functools.cache
def versions() -> Mapping[str, str]:
    """Return every installed part of MART and the libraries that shape the file; looked up once, in 70 ms."""
    installed = {d.name: d.version for d in distributions()}
    parts = {n: v for n, v in sorted(installed.items()) if n.startswith("mart-") or n in _WRITES}
    return MappingProxyType(parts)


def describe_room(file: EpisodeWriter, facts: RoomFacts, model: Model | None) -> None:
    """Write what is known about the room and its model into an open file, once, as soon as the model is known.

    A record stands in a file once, and the model says what the room's numbers depend on.
    """
    if model is not None and not file.has_model:
        facts.learn_model(model)
        if facts.is_complete:
            file.describe(facts.record())
            file.attach_model(model, clock.wall_ns())
