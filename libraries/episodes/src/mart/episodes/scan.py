"""Read MCAP records from files that nobody vouches for: memory stays bounded, damage becomes Corrupt.

The `mcap` package reads what a length field says, so a few bad bytes can ask for exabytes; here a read never exceeds
what the file still holds, and a chunk never unpacks to more than `recording.MAX_CHUNK_BYTES`.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.exceptions import McapError
from mcap.records import Chunk, McapRecord
from mcap.stream_reader import MAGIC_SIZE, CRCValidationError, StreamReader, breakup_chunk

from mart.protocol.errors import Corrupt
from mart.protocol.recording import MAX_CHUNK_BYTES, MAX_RECORD_BYTES

RECORD_HEADER_BYTES = 9  # opcode and length

# What the mcap package raises on bytes that are no MCAP, found by feeding it damaged files.
SYMPTOMS = (
    McapError, CRCValidationError, zstandard.ZstdError, struct.error, ValueError, KeyError, OverflowError, OSError,
)  # fmt: skip


class BoundedFile(io.BufferedReader):
    """Read a file that never hands out (nor makes room for) more than it has: a longer read finds its end."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path, "rb"))
        self.size = self.seek(0, io.SEEK_END)
        self.seek(0)

    def read(self, size: int | None = -1) -> bytes:
        left = self.size - self.tell()
        wanted = left if size is None or size < 0 else size
        return b"" if wanted > left else super().read(wanted)


@contextmanager
def corruption(path: Path) -> Iterator[None]:
    """Turn what the mcap package says about damaged bytes into one sentence: Corrupt."""
    try:
        yield
    except SYMPTOMS as error:
        words = " ".join(str(error).split()) or type(error).__name__
        raise Corrupt(
            f"{path} is damaged: {words}. `mart episodes repair` saves what can be read."
        ) from error


def records(file: BoundedFile, offset: int = MAGIC_SIZE) -> Iterator[McapRecord]:
    """Iterate over records from `offset` on, chunks still packed; the first damaged one raises one of `SYMPTOMS`."""
    file.seek(offset)
    reader = StreamReader(file, skip_magic=True, emit_chunks=True, record_size_limit=MAX_RECORD_BYTES)
    yield from reader.records


def unpack(chunk: Chunk) -> list[McapRecord]:
    """Return what a chunk holds. Raises ValueError where it is damaged or larger than allowed."""
    if chunk.compression not in ("", "zstd"):
        raise ValueError(f"a chunk is packed with {chunk.compression[:16]!r}; only zstd is used here")
    said = zstandard.frame_content_size(chunk.data) if chunk.compression else len(chunk.data)
    if max(said, chunk.uncompressed_size) > MAX_CHUNK_BYTES:
        raise ValueError(f"a chunk of {max(said, chunk.uncompressed_size)} bytes exceeds {MAX_CHUNK_BYTES}")
    return breakup_chunk(chunk, validate_crc=True)


def size_of(record: McapRecord) -> int:
    """Return how many bytes a record takes in a file, its header included."""
    builder = RecordBuilder()
    record.write(builder)
    return builder.count
