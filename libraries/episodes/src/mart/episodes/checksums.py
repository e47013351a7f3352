"""Check what the `mcap` package leaves unchecked: the CRCs of attachments, of the data section and of the summary.

A CRC of 0 means that the writer gave none; so does a data section whose end is not marked as MCAP marks it.
"""

from __future__ import annotations

import os
import zlib

from mcap.opcode import Opcode
from mcap.records import Attachment, DataEnd, Footer, McapRecord
from mcap.stream_reader import MAGIC_SIZE

from mart.episodes.scan import RECORD_HEADER_BYTES, BoundedFile, size_of

_CRC_BYTES = 4
_BLOCK_BYTES = 1 << 20


def require_intact(file: BoundedFile, record: McapRecord) -> None:
    """Check a record that has just been read from `file`, which stands at the record's end.

    Raises ValueError where an attachment, or what a data end or a footer vouches for, does not match its CRC. Records
    of other kinds have none of their own.
    """
    end = file.tell()
    if isinstance(record, Attachment):
        start = end - size_of(record) + RECORD_HEADER_BYTES
        _require(file, f"its attachment {record.name!r}", start, end - _CRC_BYTES)
    elif isinstance(record, DataEnd):
        start = end - size_of(record)
        if os.pread(file.fileno(), 1, start) == bytes([Opcode.DATA_END]):
            _require(file, "its data section", 0, start, record.data_section_crc)
    elif isinstance(record, Footer):
        crc_at = file.size - MAGIC_SIZE - _CRC_BYTES
        start = record.summary_start or crc_at + _CRC_BYTES - size_of(record)
        _require(file, "its summary", start, crc_at, record.summary_crc)


def _require(file: BoundedFile, what: str, start: int, end: int, said: int | None = None) -> None:
    """Compare the CRC of the bytes from `start` to before `end` with `said`, or with the four bytes that follow."""
    stored = int.from_bytes(os.pread(file.fileno(), _CRC_BYTES, end), "little") if said is None else said
    if stored and stored != _crc(file, start, end):
        raise ValueError(f"{what} does not match its checksum")


def _crc(file: BoundedFile, start: int, end: int) -> int:
    crc, at = 0, start
    while at < end:
        block = os.pread(file.fileno(), min(_BLOCK_BYTES, end - at), at)
        if not block:
            raise ValueError("it is shorter than it says")
        crc, at = zlib.crc32(block, crc), at + len(block)
    return crc
