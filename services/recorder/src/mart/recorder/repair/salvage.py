"""Walk a damaged MCAP file and find what is intact in it."""

from __future__ import annotations

import mmap
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, McapRecord, Message, Metadata, Schema

from mart.episodes.chunks import ChunkRecord, UnpackingBudget, unpack
from mart.episodes.scan import MAGIC, RECORD_HEAD, SYMPTOMS, BoundedFile, FoundRecord, parse, walk
from mart.episodes.summary import FileSummary, read_summary

# How a packed chunk goes on after its head, two times, size and checksum; see MCAP's specification, "Chunk (op=0x06)".
_CHUNK_MARKS = (b"\x04\x00\x00\x00zstd", b"\x03\x00\x00\x00lz4")
_BYTES_BEFORE_MARK = RECORD_HEAD.size + 8 + 8 + 8 + 4
_INDEX_HEAD_BYTES = 6  # of a message index: its channel, and how long its entries are together

_PARSED = (
    Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK, Opcode.ATTACHMENT, Opcode.METADATA, Opcode.HEADER,
)  # fmt: skip


@dataclass(frozen=True)
class SalvagedMessage:
    """Hold one intact message. schema: a full protobuf name."""

    topic: str
    schema: str
    payload: bytes
    arrived_ns: int
    sent_ns: int
    sequence: int


class Salvage:
    """Find what is intact in one file.

    messages: how many are intact. damaged: how many places had to be left out. orphans: messages whose channel's
    description is lost. expected: how many messages the end of the file counts; None where that is lost or was never
    written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.messages = 0
        self.damaged = 0
        self.orphans = 0
        self.expected: int | None = None
        self._channels: dict[int, Channel] = {}
        self._schemas: dict[int, Schema] = {}

    def found(self) -> Iterator[SalvagedMessage | Attachment | Metadata]:
        """Iterate over what is intact, in the order of the file."""
        with BoundedFile(self.path) as file:
            self._learn(file)
            budget = UnpackingBudget(file.size)
            at: int | None = len(MAGIC)
            while at is not None:
                broken = yield from self._run(file, at, budget)
                at = None if broken is None else _next_chunk(file, broken + 1)
                self.damaged += at is not None  # what a crash cut off at the end is no damage

    def _learn(self, file: BoundedFile) -> None:
        """Learn the channels from the end of the file, where it is intact: the first chunk may not be."""
        try:
            summary = read_summary(file)
        except SYMPTOMS:
            summary = FileSummary()
        self._channels |= summary.channels
        self._schemas |= summary.schemas
        self.expected = summary.statistics.message_count if summary.statistics else None

    def _run(
        self, file: BoundedFile, at: int, budget: UnpackingBudget
    ) -> Generator[SalvagedMessage | Attachment | Metadata, None, int | None]:
        """Read on until a record does not hold together; return where, or None at the end of the data."""
        try:
            for place in walk(file, at):
                at = place.at
                if place.opcode == Opcode.FOOTER:  # the end, unless it is a spoilt byte that reads like one
                    return None if file.size - place.end <= len(MAGIC) else at
                record = _intact(file, place)
                at = place.end
                yield from self._open(record, budget)
        except SYMPTOMS:
            return at
        return None

    def _open(
        self, record: McapRecord | None, budget: UnpackingBudget
    ) -> Iterator[SalvagedMessage | Attachment | Metadata]:
        if isinstance(record, Attachment | Metadata):
            yield record
        elif isinstance(record, Chunk):
            try:
                for inner in unpack(record, budget):
                    yield from self._messages(inner)
            except SYMPTOMS:
                self.damaged += 1
        elif isinstance(record, Schema):  # outside of chunks nothing vouches for what is said
            self._schemas.setdefault(record.id, record)
        elif isinstance(record, Channel):
            self._channels.setdefault(record.id, record)
        elif isinstance(record, Message):
            budget.spend_message()
            yield from self._messages(record)

    def _messages(self, record: ChunkRecord) -> Iterator[SalvagedMessage]:
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
        else:
            channel = self._channels.get(record.channel_id)
            schema = self._schemas.get(channel.schema_id) if channel else None
            if channel is None or schema is None:
                self.orphans += 1
            else:
                self.messages += 1
                times = record.log_time, record.publish_time, record.sequence
                yield SalvagedMessage(channel.topic, schema.name, record.data, *times)


def _intact(file: BoundedFile, place: FoundRecord) -> McapRecord | None:
    """Return what a record says, None for one that is not needed. Raises one of `SYMPTOMS` for a damaged one.

    A length inside of it can be spoilt too, and so can its own: it must be as long as its content takes; where that is
    not known, what follows must be the beginning of another.
    """
    if place.opcode in _PARSED:
        record = parse(file, place)
        if _size_of(record) != place.end - place.at:
            raise ValueError("a record is not as long as its content")
        return record
    if place.opcode == Opcode.MESSAGE_INDEX:
        head = file.piece(place.at + RECORD_HEAD.size, _INDEX_HEAD_BYTES)
        if int.from_bytes(head[2:], "little") != place.size_bytes - _INDEX_HEAD_BYTES:
            raise ValueError("an index is not as long as its entries")
    else:
        _require_another(file, place.end)
    return None


def _require_another(file: BoundedFile, at: int) -> None:
    """Raise ValueError where what follows a record cannot be another; where the file was cut off, nothing follows."""
    if file.size - at < RECORD_HEAD.size:
        return
    opcode, size_bytes = RECORD_HEAD.unpack(file.piece(at, RECORD_HEAD.size))
    if opcode == 0 or size_bytes >= 1 << 40:
        raise ValueError(f"at byte {at} no record begins")


def _size_of(record: McapRecord) -> int:
    """Return how many bytes a record takes in a file, its head included."""
    builder = RecordBuilder()
    record.write(builder)
    return builder.count


def _next_chunk(file: BoundedFile, start: int) -> int | None:
    """Return where the next thing that looks like a chunk begins, at or after `start`."""
    if start >= file.size:
        return None
    with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as view:
        found = [at for mark in _CHUNK_MARKS if (at := _marked(view, mark, start)) is not None]
    return min(found, default=None)


def _marked(view: mmap.mmap, mark: bytes, start: int) -> int | None:
    at_mark = view.find(mark, start)
    while at_mark >= 0:
        at = at_mark - _BYTES_BEFORE_MARK
        if at >= start and view[at] == Opcode.CHUNK:
            return at
        at_mark = view.find(mark, at_mark + 1)
    return None
