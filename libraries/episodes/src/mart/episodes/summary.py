"""Read what the end of a finished MCAP file says of the rest: counts, channels, where metadata is."""

from __future__ import annotations

from dataclasses import dataclass, field

from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import Channel, Footer, MetadataIndex, Schema, Statistics

from mart.episodes.scan import MAGIC, RECORD_HEAD, BoundedFile, FoundRecord, crc_of, parse, walk

_FOOTER_BYTES = 20
_CRC_BYTES = 4
_WANTED = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.STATISTICS, Opcode.METADATA_INDEX)


@dataclass(frozen=True)
class FileSummary:
    """Hold what the end of a file says. statistics: None where a writer left them out, and all else is empty then."""

    statistics: Statistics | None = None
    channels: dict[int, Channel] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    metadata: tuple[MetadataIndex, ...] = ()


def read_summary(file: BoundedFile) -> FileSummary:
    """Read the summary of a finished file, its checksum checked; an empty one where the writer made none.

    Raises EndOfFile where the file does not end as one that is finished, and others of `SYMPTOMS` for a damaged one.
    """
    footer_at = file.size - len(MAGIC) - _FOOTER_BYTES - RECORD_HEAD.size
    if footer_at < len(MAGIC) or file.piece(file.size - len(MAGIC), len(MAGIC)) != MAGIC:
        raise EndOfFile("it is cut off: the end of an MCAP file is missing")
    footer = parse(file, FoundRecord(Opcode.FOOTER, footer_at, _FOOTER_BYTES))
    head = file.piece(footer_at, RECORD_HEAD.size)
    if not isinstance(footer, Footer) or head != RECORD_HEAD.pack(Opcode.FOOTER, _FOOTER_BYTES):
        raise EndOfFile("it is cut off: there is no footer at its end")
    start, end = footer.summary_start or footer_at, footer_at + RECORD_HEAD.size + _FOOTER_BYTES - _CRC_BYTES
    if not len(MAGIC) <= start <= footer_at:
        raise ValueError(f"its summary is said to begin at byte {start}")
    if footer.summary_crc and crc_of(file, start, end) != footer.summary_crc:
        raise ValueError("its summary does not match its checksum")
    return _read(file, start, footer_at)


def _read(file: BoundedFile, start: int, end: int) -> FileSummary:
    statistics: Statistics | None = None
    channels, schemas, metadata = dict[int, Channel](), dict[int, Schema](), list[MetadataIndex]()
    for found in walk(file, start, end):
        record = parse(file, found) if found.opcode in _WANTED else None
        if isinstance(record, Statistics):
            statistics = record
        elif isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, MetadataIndex):
            metadata.append(record)
    return FileSummary(statistics, channels, schemas, tuple(metadata))
