"""One episode file, read: its metadata at once, its messages one by one. Also a `.part`, as far as it goes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from mcap.exceptions import EndOfFile
from mcap.reader import SeekingReader
from mcap.records import Channel, Chunk, McapRecord, Message, Metadata
from mcap.stream_reader import MAGIC_SIZE

from mart.episodes.scan import BoundedFile, corruption, records, unpack
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.recording import (
    MAX_RECORD_BYTES,
    MODEL_ATTACHMENT,
    PROFILE,
    SUFFIX,
    CadenceRecord,
    EpisodeRecord,
    OperatorsRecord,
    RoomRecord,
    VerificationRecord,
)


@dataclass(frozen=True)
class RecordedMessage:
    """One message of a file."""

    topic: str
    payload: bytes
    arrived_ns: int
    sent_ns: int
    sequence: int


@dataclass(frozen=True)
class EpisodeFile:
    """Opens its file for each question and closes it again. Raises Corrupt where the file cannot be trusted."""

    path: Path
    strings: Mapping[str, Mapping[str, str]]  # metadata records by name

    @classmethod
    def open(cls, path: Path) -> EpisodeFile:
        """Raises NotFound where there is no file and Corrupt where it is no episode."""
        if not path.is_file():
            raise NotFound(f"There is no file {path}; name an episode file or a folder of them.")
        with BoundedFile(path) as file, corruption(path):
            return cls(path, {metadata.name: metadata.metadata for metadata in _metadata(file, path)})

    @property
    def episode(self) -> EpisodeRecord:
        return EpisodeRecord.from_strings(self._record(EpisodeRecord.NAME))

    @property
    def cadence(self) -> CadenceRecord:
        return CadenceRecord.from_strings(self._record(CadenceRecord.NAME))

    @property
    def operators(self) -> OperatorsRecord:
        return OperatorsRecord.from_strings(self._record(OperatorsRecord.NAME))

    @property
    def verification(self) -> VerificationRecord:
        return VerificationRecord.from_strings(self._record(VerificationRecord.NAME))

    @property
    def room(self) -> RoomRecord:
        return RoomRecord.from_strings(self._record(RoomRecord.NAME))

    def messages(self, *topics: str) -> Iterator[RecordedMessage]:
        """Messages of these topics, or of all, in the order of the file."""
        with BoundedFile(self.path) as file, corruption(self.path):
            for channel, message in messages(_until_cut(records(file), self.path)):
                if not topics or channel.topic in topics:
                    yield RecordedMessage(
                        channel.topic, message.data, message.log_time, message.publish_time, message.sequence
                    )

    def model(self) -> bytes:
        """The compiled model; raises NotFound where the file has none."""
        with BoundedFile(self.path) as file, corruption(self.path):
            for attachment in _reader(file).iter_attachments():
                if attachment.name == MODEL_ATTACHMENT:
                    return attachment.data
        raise NotFound(f"{self.path} holds no {MODEL_ATTACHMENT}.")

    def check(self, expected_messages: int | None = None) -> None:
        """Reads all of it, every checksum included; raises Corrupt where anything is amiss or missing."""
        found = sum(1 for _ in self.messages())
        with BoundedFile(self.path) as file, corruption(self.path):
            summary = _reader(file).get_summary()
        counted = summary.statistics.message_count if summary and summary.statistics else None
        if found != counted or expected_messages not in (None, found):
            expected = counted if expected_messages is None else expected_messages
            raise Corrupt(f"{self.path} holds {found} messages; it should hold {expected}.")

    def _record(self, name: str) -> Mapping[str, str]:
        if name not in self.strings:
            raise Corrupt(f"{self.path} has no record {name}; is it an episode of MART?")
        return self.strings[name]


def messages(found: Iterator[McapRecord]) -> Iterator[tuple[Channel, Message]]:
    """Messages with their channels, from records whose chunks are still packed."""
    channels: dict[int, Channel] = {}
    for outer in found:
        for record in unpack(outer) if isinstance(outer, Chunk) else ():
            if isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                yield channels[record.channel_id], record


def _metadata(file: BoundedFile, path: Path) -> Iterator[Metadata]:
    if path.suffix != SUFFIX:
        yield from (record for record in _until_cut(records(file), path) if isinstance(record, Metadata))
        return
    reader = _reader(file)
    if reader.get_header().profile != PROFILE:
        raise Corrupt(f"{path} is an MCAP file of another kind; MART's have the profile {PROFILE!r}.")
    yield from reader.iter_metadata()


def _reader(file: BoundedFile) -> SeekingReader:
    file.seek(0)
    if file.size < 2 * MAGIC_SIZE:
        raise EndOfFile(f"{file.size} bytes are too few")
    return SeekingReader(file, record_size_limit=MAX_RECORD_BYTES)


def _until_cut(found: Iterator[McapRecord], path: Path) -> Iterator[McapRecord]:
    """A file that is not complete ends where it was cut; any other must not."""
    try:
        yield from found
    except EndOfFile:
        if path.suffix == SUFFIX:
            raise
