"""Make episode files of what a crash has left: every intact message is kept, nothing is invented.

A `.part` ends anywhere, and a power cut or a bad disk may have spoilt bytes before that. Records are read one by one;
where one does not hold together, the next intact chunk is searched. Memory stays at one record, whatever the file.
"""

from __future__ import annotations

import fcntl
import logging
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from google.protobuf.message import Message
from mcap.records import Attachment, Metadata

from mart.episodes.mcap_entries import McapEntry, state_entries
from mart.episodes.reader import EpisodeFile
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.errors import Corrupt, MartError
from mart.protocol.messages import Command, Event, Model, State
from mart.protocol.recording import MODEL_ATTACHMENT, PART_SUFFIX, RoomRecord
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import SavedEpisode, VerifyFile, finalize, free_path
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.repair.salvage import Salvage, SalvagedMessage

_log = logging.getLogger(__name__)

_MENDING_SUFFIX = ".mcap.mending"
_HOPELESS_SUFFIX = ".mcap.unreadable"

# What a file holds besides messages that are derived from states; those are derived anew.
_KEPT: dict[str, type[Message]] = {
    kind.DESCRIPTOR.full_name: kind for kind in (State, Command, Event, CompressedVideo)
}


@dataclass(frozen=True)
class RepairResult:
    """Tell what became of one leftover: an episode, or the reason why there is none."""

    part: Path
    saved: SavedEpisode | None
    detail: str


def repair_all(root: Path, verify: VerifyFile) -> Iterator[RepairResult]:
    """Repair every leftover under `root`. Files that a recorder is writing are locked, and left alone."""
    for stale in root.rglob(f"*{_MENDING_SUFFIX}"):
        with _exclusive(stale) as free:
            if free:
                stale.unlink()
    for part in sorted(root.rglob(f"*{PART_SUFFIX}")):
        with _exclusive(part) as free:
            if free:
                yield _repair(part, root, verify)


def _repair(part: Path, root: Path, verify: VerifyFile) -> RepairResult:
    try:
        return _adopt(part, root) or _mend(part, root, verify)
    except (MartError, OSError) as error:
        return RepairResult(part, None, f"It stays as it is: {error}")


def _adopt(part: Path, root: Path) -> RepairResult | None:
    """Name a file that was complete and only lacked its name; None for any other."""
    try:
        file = EpisodeFile.open(part)
        file.check()
        episode, cadence, verification = file.episode, file.cadence, file.verification
    except Corrupt:
        return None
    path = free_path(root, episode)
    path.parent.mkdir(parents=True, exist_ok=True)
    saved = SavedEpisode(part.rename(path), episode, cadence, verification, path.stat().st_size)
    return RepairResult(part, saved, "It was complete and only lacked its name.")


def _mend(part: Path, root: Path, verify: VerifyFile) -> RepairResult:
    mending = part.with_name(part.name.removesuffix(PART_SUFFIX) + _MENDING_SUFFIX)
    file = EpisodeWriter(mending)
    try:
        salvage = Salvage(part)
        mended = _Mended(file)
        for found in salvage.found():
            mended.add(found)
        if mended.episode is None:
            return _give_up(part, file)
        mended.episode.conclude(unfinished_reason="the recording was cut short")
        saved = finalize(file, mended.episode, mended.facts, root, verify, repaired=True)
    except BaseException:
        file.abandon()
        mending.unlink(missing_ok=True)
        raise
    part.unlink()
    lost = f"; {salvage.damaged} damaged places" if salvage.damaged else ""
    lost += f", {salvage.orphans} messages without their channel" if salvage.orphans else ""
    return RepairResult(part, saved, f"{file.messages} messages kept{lost}.")


def _give_up(part: Path, file: EpisodeWriter) -> RepairResult:
    file.abandon()
    file.path.unlink()
    kept = part.rename(part.with_name(part.name.removesuffix(PART_SUFFIX) + _HOPELESS_SUFFIX))
    return RepairResult(part, None, f"It holds no intact state; kept as {kept}.")


class _Mended:
    """Copy what was found into a new file and gather what the episode was."""

    def __init__(self, file: EpisodeWriter) -> None:
        self.episode: EpisodeAccumulator | None = None
        self.facts = RoomFacts("")
        self._file = file
        self._early: list[Event | Command] = []  # before the first state

    def add(self, found: SalvagedMessage | Attachment | Metadata) -> None:
        if isinstance(found, SalvagedMessage):
            self._add_message(found)
        elif isinstance(found, Metadata):
            self._add_metadata(found)
        elif found.name == MODEL_ATTACHMENT and sha256(found.data).hexdigest() == self.facts.model_sha256:
            self._file.attach_model(Model(mjb=found.data), found.log_time)

    def _add_metadata(self, metadata: Metadata) -> None:
        if metadata.name == RoomRecord.NAME:
            record = RoomRecord.from_strings(metadata.metadata)
            self.facts.room = record.room
            self.facts.learn_record(record)

    def _add_message(self, found: SalvagedMessage) -> None:
        kind = _KEPT.get(found.schema)
        if kind is State:
            self._add_state(found)
            return
        if kind is not None:
            self._file.add(
                McapEntry(found.topic, kind, found.payload, found.arrived_ns, found.sent_ns, found.sequence)
            )
        if kind is Event:
            event = codec.decode(Event, found.payload)
            self.facts.learn_event(event)
            self._tell(event)
        elif kind is Command:
            self._tell(codec.decode(Command, found.payload))

    def _add_state(self, found: SalvagedMessage) -> None:
        state = codec.decode(State, found.payload)
        if self.episode is None:
            self.facts.room = state.room
            self.episode = EpisodeAccumulator(state)
            for early in self._early:
                self._tell(early)
        self.episode.add_state(state)
        for entry in state_entries(state, found.payload, found.arrived_ns, self.facts.task):
            self._file.add(entry)

    def _tell(self, said: Event | Command) -> None:
        if self.episode is None:
            self._early.append(said)
        elif isinstance(said, Event):
            self.episode.add_event(said)
        else:
            self.episode.add_command(said.arm, said)


@contextmanager
def _exclusive(path: Path) -> Iterator[bool]:
    """Tell whether nobody is writing this file; if so, nobody else repairs it meanwhile."""
    with ExitStack() as stack:
        try:
            file = stack.enter_context(path.open("rb"))
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, FileNotFoundError) as error:
            _log.debug("%s is left alone: %s", path, error)
            yield False
        else:
            yield os.fstat(file.fileno()).st_nlink > 0  # 0: somebody has just finished with it


def log_repairs(repairs: Iterator[RepairResult]) -> Iterator[SavedEpisode]:
    """Log what was done and pass on what was saved."""
    for repaired in repairs:
        if repaired.saved is None:
            _log.error("%s could not be repaired. %s", repaired.part, repaired.detail)
        else:
            _log.warning("%s repaired: %s %s", repaired.part, repaired.saved.path, repaired.detail)
            yield repaired.saved
