"""Copy what is intact in a file into a new one, and gather what the episode was."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from google.protobuf.message import Message
from mcap.records import Attachment, Metadata

from mart.episodes.mcap_entries import McapEntry, state_entries
from mart.episodes.writer import EpisodeWriter
from mart.protocol import codec
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import Command, Event, Model, Operator, State
from mart.protocol.recording import (
    CHECKSUMS,
    MODEL_ATTACHMENT,
    TASK_ATTACHMENT,
    EpisodeRecord,
    OperatorsRecord,
    RoomRecord,
    metadata_checksum,
)
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import NameFile, RecordedFacts, SavedEpisode, VerifyFile, complete
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.repair.salvage import Salvage, SalvagedMessage

# What a file holds besides messages that are derived from states; those are derived anew.
_KEPT: dict[str, type[Message]] = {
    kind.DESCRIPTOR.full_name: kind for kind in (State, Command, Event, CompressedVideo)
}


def mend(source: Path, mending: Path, verify: VerifyFile, name: NameFile) -> tuple[SavedEpisode, str] | None:
    """Write what is intact in `source` into a new file, and say in a sentence what was kept; None where no state is.

    mending: where to write it. name: gives the finished file its name.
    """
    file = EpisodeWriter(mending)
    try:
        salvage = Salvage(source)
        mended = _Mended(file)
        for found in salvage.found():
            mended.add(found)
        if mended.episode is None:
            file.discard()
            return None
        mended.episode.conclude(unfinished_reason="the recording was cut short")
        saved = complete(
            file, mended.episode, mended.facts, name, verify, repaired=True, recorded=mended.recorded()
        )
    except BaseException:
        file.abandon()
        mending.unlink(missing_ok=True)
        raise
    return saved, _in_words(salvage, mended.unreadable)


def _in_words(salvage: Salvage, unreadable: int) -> str:
    expected = "" if salvage.expected is None else f" of {salvage.expected}"
    lost = f"; {salvage.damaged} damaged places" if salvage.damaged else ""
    lost += f", {salvage.orphans} messages without their channel" if salvage.orphans else ""
    lost += f", {unreadable} messages that cannot be read or are of another episode" if unreadable else ""
    return f"{salvage.messages - unreadable}{expected} messages kept{lost}."


class _Mended:
    """Copy what was found into a new file and gather what the episode was.

    unreadable: messages that were left out because they are not what they are said to be, or of another episode.
    """

    def __init__(self, file: EpisodeWriter) -> None:
        self.episode: EpisodeAccumulator | None = None
        self.facts = RoomFacts("")
        self.unreadable = 0
        self._file = file
        self._early: list[Event | Command] = []  # before the first state
        self._metadata: dict[str, Mapping[str, str]] = {}
        self._checksums: dict[str, str] = {}
        self._room: Mapping[str, str] | None = None
        self._task_file = b""  # comes before the model

    def add(self, found: SalvagedMessage | Attachment | Metadata) -> None:
        if not isinstance(found, Metadata):
            self._learn_room()
        if isinstance(found, SalvagedMessage):
            try:
                self._add_message(found)
            except InvalidInput:
                self.unreadable += 1
        elif isinstance(found, Metadata):
            self._add_metadata(found)
        elif found.name == TASK_ATTACHMENT:
            self._task_file = found.data
        elif found.name == MODEL_ATTACHMENT and not self._file.has_model and self._is_recorded(found.data):
            self._file.attach_model(Model(mjb=found.data, task_file=self._task_file), found.log_time)

    def recorded(self) -> RecordedFacts:
        """Return what the file says of the episode itself, as far as its own checksums vouch for it."""
        vouched = {
            name: strings
            for name, strings in self._metadata.items()
            if self._checksums.get(name) == metadata_checksum(strings)
        }
        try:
            episode, operators = vouched.get(EpisodeRecord.NAME), vouched.get(OperatorsRecord.NAME)
            return RecordedFacts(
                episode=None if episode is None else EpisodeRecord.from_strings(episode),
                operators=None if operators is None else OperatorsRecord.from_strings(operators),
            )
        except Corrupt:  # of a version that says more than this one understands
            return RecordedFacts()

    def _is_recorded(self, mjb: bytes) -> bool:
        return sha256(mjb).hexdigest() == self.facts.model_sha256

    def _add_metadata(self, metadata: Metadata) -> None:
        if metadata.name == CHECKSUMS:
            self._checksums |= metadata.metadata
        else:
            self._metadata[metadata.name] = metadata.metadata

    def _learn_room(self) -> None:
        """Learn what the file says of its room by now; its checksum, where there is one, follows at once."""
        said = self._metadata.get(RoomRecord.NAME)
        if said is None or said == self._room:
            return
        self._room = said
        if self._checksums.get(RoomRecord.NAME, metadata_checksum(said)) != metadata_checksum(said):
            return
        try:
            record = RoomRecord.from_strings(said)
        except Corrupt:  # without a checksum, in an older file: events say the same
            return
        self.facts.room = record.room
        self.facts.learn_record(record)

    def _add_message(self, found: SalvagedMessage) -> None:
        kind = _KEPT.get(found.schema)
        if kind is State:
            self._add_state(found)
            return
        said = codec.decode(kind, found.payload) if kind in (Event, Command) else None
        if kind is not None:
            self._file.add(
                McapEntry(found.topic, kind, found.payload, found.arrived_ns, found.sent_ns, found.sequence)
            )
        if isinstance(said, Event):
            self.facts.learn_event(said)
        if isinstance(said, Event | Command):
            self._tell(said)

    def _add_state(self, found: SalvagedMessage) -> None:
        state = codec.decode(State, found.payload)
        if any(arm.source not in Operator.values() for arm in state.arms):
            raise InvalidInput("A state names a kind of operator that this version does not know.")
        if self.episode is None:
            self.facts.room = state.room
            self.episode = EpisodeAccumulator(state)
            for early in self._early:
                self._tell(early)
        if not self.episode.belongs(state):
            self.unreadable += 1
            return
        self.episode.add_state(state, found.arrived_ns)
        for entry in state_entries(
            state, found.payload, found.arrived_ns, self.facts.task, self.facts.arm_kinds
        ):
            self._file.add(entry)

    def _tell(self, said: Event | Command) -> None:
        if self.episode is None:
            self._early.append(said)
        elif isinstance(said, Event):
            self.episode.add_event(said)
        else:
            self.episode.add_command(said.arm, said)
