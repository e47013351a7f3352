"""Walk a damaged MCAP file and find what is intact in it."""

from __future__ import annotations

import mmap
import os
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Footer, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import MAGIC_SIZE

from mart.episodes.scan import RECORD_HEADER_BYTES, SYMPTOMS, BoundedFile, records, size_of, unpack

# How a zstd chunk goes on after its header, two times, size and checksum; see MCAP's specification, "Chunk (op=0x06)".
_CHUNK_MARK = b"\x04\x00\x00\x00zstd"
_BYTES_BEFORE_MARK = RECORD_HEADER_BYTES + 8 + 8 + 8 + 4


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

    damaged: how many places had to be left out. orphans: messages whose channel's description is lost.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.damaged = 0
        self.orphans = 0
        self._channels: dict[int, Channel] = {}
        self._schemas: dict[int, Schema] = {}

    def found(self) -> Iterator[SalvagedMessage | Attachment | Metadata]:
        """Iterate over what is intact, in the order of the file."""
        with BoundedFile(self.path) as file:
            at: int | None = MAGIC_SIZE
            while at is not None:
                broken = yield from self._run(file, at)
                at = None if broken is None else _next_chunk(file, broken + 1)
                self.damaged += at is not None  # what a crash cut off at the end is no damage

    def _run(
        self, file: BoundedFile, at: int
    ) -> Generator[SalvagedMessage | Attachment | Metadata, None, int | None]:
        """Read on until a record does not hold together; return where, or None at the end of the file."""
        found = records(file, at)
        while True:
            try:
                record = next(found)
                if not _holds_together(file, at, record):
                    return at
                if isinstance(record, Footer):  # the end, unless it is a spoilt byte that reads like one
                    return None if file.size - file.tell() <= MAGIC_SIZE else at
            except StopIteration:
                return None
            except SYMPTOMS:
                return at
            at = file.tell()
            yield from self._open(record)

    def _open(self, record: McapRecord) -> Iterator[SalvagedMessage | Attachment | Metadata]:
        if isinstance(record, Attachment | Metadata):
            yield record
        elif isinstance(record, Chunk):
            try:
                inner = unpack(record)
            except SYMPTOMS:
                self.damaged += 1
            else:
                yield from self._messages(inner)

    def _messages(self, chunk: list[McapRecord]) -> Iterator[SalvagedMessage]:
        for record in chunk:
            if isinstance(record, Schema):
                self._schemas[record.id] = record
            elif isinstance(record, Channel):
                self._channels[record.id] = record
            elif isinstance(record, Message):
                channel = self._channels.get(record.channel_id)
                schema = self._schemas.get(channel.schema_id) if channel else None
                if channel is None or schema is None:
                    self.orphans += 1
                else:
                    yield _found(channel, schema, record)


def _found(channel: Channel, schema: Schema, message: Message) -> SalvagedMessage:
    times = message.log_time, message.publish_time, message.sequence
    return SalvagedMessage(channel.topic, schema.name, message.data, *times)


def _holds_together(file: BoundedFile, at: int, record: McapRecord) -> bool:
    """Tell whether what was read from `at` on is as long as its header says and as its content takes.

    A length inside the content can be spoilt too: the reader follows it, whatever the header says.
    """
    said = int.from_bytes(os.pread(file.fileno(), 8, at + 1), "little")
    return size_of(record) == RECORD_HEADER_BYTES + said == file.tell() - at


def _next_chunk(file: BoundedFile, start: int) -> int | None:
    """Return where the next thing that looks like a chunk begins, at or after `start`."""
    if start >= file.size:
        return None
    with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as view:
        mark = view.find(_CHUNK_MARK, start)
        while mark >= 0:
            at = mark - _BYTES_BEFORE_MARK
            if at >= start and view[at] == Opcode.CHUNK:
                return at
            mark = view.find(_CHUNK_MARK, mark + 1)
    return None
