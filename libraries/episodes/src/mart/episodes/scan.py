"""Read MCAP records from files that nobody vouches for: memory stays bounded, damage becomes Corrupt.

The framing (an opcode and a length, MCAP's specification, "Records") is walked here, so that nothing is read that is
not wanted, nothing beyond its own length, and what other tools have added is passed over; what a record says is parsed
by the `mcap` package. Chunks stay packed: `mart.episodes.chunks` opens them.
"""

from __future__ import annotations

import io
import os
import stat
import struct
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.recording import MAX_RECORD_BYTES

MAGIC = b"\x89MCAP0\r\n"
RECORD_HEAD = struct.Struct("<BQ")  # opcode and length
_CRC_BYTES = 4
_PIECE_BYTES = 1024 * 1024

# What the mcap package raises on bytes that are no MCAP, found by feeding it damaged files.
SYMPTOMS = (
    McapError, zstandard.ZstdError, struct.error, ValueError, KeyError, OverflowError,
)  # fmt: skip

_PARSED: Mapping[int, Callable[[ReadDataStream], McapRecord]] = {
    Opcode.HEADER: Header.read,
    Opcode.FOOTER: Footer.read,
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.CHUNK: Chunk.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.METADATA: Metadata.read,
    Opcode.METADATA_INDEX: MetadataIndex.read,
    Opcode.STATISTICS: Statistics.read,
    Opcode.DATA_END: DataEnd.read,
}


class ForeignFile(Corrupt):
    """What was named is no episode file of MART's, and not a damaged one either."""


class FoundRecord(NamedTuple):
    """Tell where a record is. at: of its opcode. size_bytes: of its content, as its head says and the file holds."""

    opcode: int
    at: int
    size_bytes: int

    @property
    def end(self) -> int:
        """Tell where the next record begins."""
        return self.at + RECORD_HEAD.size + self.size_bytes


class BoundedFile(io.FileIO):
    """Read a file by places, never more than it holds. size: in bytes, when it was opened.

    Raises NotFound where there is no file, and Corrupt for what is none (a folder, a device) or cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        try:
            if not stat.S_ISREG(path.stat().st_mode):
                raise ForeignFile(f"{path} is no file but a folder or a device; move it out of the way.")
            super().__init__(path, "rb")
            self.size = os.fstat(self.fileno()).st_size
        except FileNotFoundError as error:
            lost = f", which is a link to {os.readlink(path)}, where nothing is" if path.is_symlink() else ""
            raise NotFound(
                f"There is no file {path}{lost}; name an episode file or a folder of them."
            ) from error
        except (OSError, ValueError) as error:
            raise unreadable(path, error) from error

    def piece(self, at: int, size_bytes: int) -> bytes:
        """Return so many bytes from a place on. Raises EndOfFile where the file does not hold them."""
        if size_bytes > self.size - at:
            raise EndOfFile(f"{size_bytes} bytes from byte {at} on go beyond its end")
        found = os.pread(self.fileno(), size_bytes, at)
        if len(found) != size_bytes:
            raise EndOfFile(f"it has become shorter than {at + size_bytes} bytes meanwhile")
        return found

    def content(self, record: FoundRecord) -> bytes:
        """Return what a record holds. Raises ValueError where that is more than a reader takes."""
        if record.size_bytes > MAX_RECORD_BYTES:
            raise ValueError(f"a record of {record.size_bytes} bytes exceeds {MAX_RECORD_BYTES}")
        return self.piece(record.at + RECORD_HEAD.size, record.size_bytes)


def unreadable(path: Path, error: Exception) -> Corrupt:
    """Return the error for a file that the system does not hand out."""
    words = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return Corrupt(f"{path} cannot be read: {words}.")


@contextmanager
def corruption(path: Path) -> Iterator[None]:
    """Turn what the mcap package says about damaged bytes, and the system about a bad disk, into Corrupt."""
    try:
        yield
    except OSError as error:
        raise unreadable(path, error) from error
    except SYMPTOMS as error:
        words = " ".join(str(error).split()) or type(error).__name__
        raise Corrupt(
            f"{path} is damaged: {words[:300]}. `mart episodes repair` with its path saves what can be read, into a "
            "new file."
        ) from error


def walk(file: BoundedFile, at: int = len(MAGIC), end: int | None = None) -> Iterator[FoundRecord]:
    """Iterate over the records from a place on, up to the footer or to `end`; nothing but their heads is read.

    Raises EndOfFile where the file ends before either, or where a record is longer than what is left of it.
    """
    while at != end:
        opcode, size_bytes = RECORD_HEAD.unpack(file.piece(at, RECORD_HEAD.size))
        found = FoundRecord(opcode, at, size_bytes)
        if opcode == 0:
            raise ValueError(f"at byte {at} there is no record, which none may have the opcode 0")
        if found.end > (file.size if end is None else end):
            raise EndOfFile(f"a record of {size_bytes} bytes at byte {at} goes beyond its end")
        yield found
        if opcode == Opcode.FOOTER:
            return
        at = found.end


def parse(file: BoundedFile, record: FoundRecord) -> McapRecord:
    """Return what a record says. Raises one of `SYMPTOMS` where it does not hold together."""
    return parsed(record.opcode, file.content(record))


def parsed(opcode: int, content: bytes) -> McapRecord:
    """Return what a record with this content says; an attachment's checksum is checked.

    What follows the fields that are known is passed over, as the specification asks. Raises one of `SYMPTOMS`.
    """
    if opcode == Opcode.MESSAGE:
        return Message.read(ReadDataStream(_Exact(content)), len(content))
    record = _PARSED[opcode](ReadDataStream(_Exact(content)))
    if isinstance(record, Attachment):
        said = int.from_bytes(content[-_CRC_BYTES:], "little")
        if said and zlib.crc32(memoryview(content)[:-_CRC_BYTES]) != said:
            raise ValueError(f"its attachment {record.name[:64]!r} does not match its checksum")
    return record


def crc_of(file: BoundedFile, start: int, end: int) -> int:
    """Return the CRC-32 of the bytes from `start` to before `end`. Raises EndOfFile where the file has fewer."""
    crc, at = 0, start
    while at < end:
        piece = file.piece(at, min(_PIECE_BYTES, end - at))
        crc, at = zlib.crc32(piece, crc), at + len(piece)
    return crc


class _Exact(io.BytesIO):
    """Hand out what is asked for or nothing, which the mcap package takes for the end: it does not look at less."""

    def read(self, size: int | None = -1) -> bytes:
        wanted = -1 if size is None else size
        found = super().read(wanted)
        return found if len(found) >= wanted else b""
