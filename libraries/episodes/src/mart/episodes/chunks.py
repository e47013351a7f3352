"""Open the chunks of an MCAP file: every compression that the format knows, within bounds, every checksum checked."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator

import lz4.frame
import zstandard
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Schema

from mart.episodes.scan import RECORD_HEAD, parsed
from mart.protocol.recording import (
    MAX_CHUNK_BYTES,
    MAX_MESSAGES,
    MAX_UNPACKED_TIMES,
    MIN_UNPACKED_BYTES,
)

_MESSAGE_HEAD = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
ChunkRecord = Schema | Channel | Message


class UnpackingBudget:
    """Bound what one file may unpack to, so that a small file costs little: what it packs, and how many messages.

    Each call raises ValueError once it is spent.
    """

    def __init__(self, file_bytes: int) -> None:
        self._limit_bytes = self._left_bytes = MIN_UNPACKED_BYTES + MAX_UNPACKED_TIMES * file_bytes
        self._left_messages = MAX_MESSAGES

    def spend_bytes(self, size_bytes: int) -> None:
        """Count what a chunk says it unpacks to, before it is unpacked."""
        if size_bytes > MAX_CHUNK_BYTES:
            raise ValueError(f"a chunk of {size_bytes} bytes exceeds {MAX_CHUNK_BYTES}")
        if size_bytes > self._left_bytes:
            raise ValueError(
                f"its chunks unpack to more than {self._limit_bytes} bytes, which no file of this size does"
            )
        self._left_bytes -= size_bytes

    def spend_message(self) -> None:
        """Count one message."""
        self._left_messages -= 1
        if self._left_messages < 0:
            raise ValueError(f"it holds more than {MAX_MESSAGES} messages, which no episode does")


def unpack(chunk: Chunk, budget: UnpackingBudget) -> Iterator[ChunkRecord]:
    """Iterate over what a chunk holds. Raises one of `SYMPTOMS`, before anything else where it is damaged."""
    data = _unpacked(chunk, budget)
    at = 0
    while at < len(data):
        opcode, size_bytes = RECORD_HEAD.unpack_from(data, at)
        at += RECORD_HEAD.size
        end = at + size_bytes
        if end > len(data):
            raise ValueError("a record in a chunk goes beyond its end")
        if opcode == Opcode.MESSAGE:
            budget.spend_message()
            yield _message(data, at, end)
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            record = parsed(opcode, data[at:end])
            assert isinstance(record, Schema | Channel)
            yield record
        at = end


def _message(data: bytes, at: int, end: int) -> Message:
    payload_at = at + _MESSAGE_HEAD.size
    if payload_at > end:
        raise ValueError("a message in a chunk is shorter than its own head")
    channel, sequence, log_time, publish_time = _MESSAGE_HEAD.unpack_from(data, at)
    return Message(channel, log_time, data[payload_at:end], publish_time, sequence)


def _unpacked(chunk: Chunk, budget: UnpackingBudget) -> bytes:
    said = chunk.uncompressed_size
    match chunk.compression:
        case "":
            _require_size(len(chunk.data), said)
            budget.spend_bytes(said)
            data = chunk.data
        case "zstd":
            size_bytes = zstandard.frame_content_size(chunk.data)
            if size_bytes >= 0:  # a spoilt size costs its chunk, not what the rest of the file may unpack to
                _require_size(size_bytes, said)
            budget.spend_bytes(said)
            data = zstandard.decompress(chunk.data, said) if said else b""
        case "lz4":
            budget.spend_bytes(said)
            data = _unpacked_lz4(chunk.data, said)
        case other:
            raise ValueError(f"a chunk is packed with {other[:16]!r}; zstd, lz4 and nothing are known")
    _require_size(len(data), said)
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise ValueError("a chunk does not match its checksum")
    return data


def _require_size(size_bytes: int, said: int) -> None:
    if size_bytes != said:
        raise ValueError(f"a chunk holds {size_bytes} bytes and says {said}")


def _unpacked_lz4(packed: bytes, size_bytes: int) -> bytes:
    try:
        unpacking = lz4.frame.LZ4FrameDecompressor()
        return bytes(
            unpacking.decompress(packed, max_length=size_bytes + 1)
        )  # one more tells that there is more
    except RuntimeError as error:
        raise ValueError(f"a chunk of lz4 cannot be unpacked: {error}") from error
