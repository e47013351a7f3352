"""Read the three things that an MCAP file holds, messages, metadata and attachments, wherever the format has them.

Other tools write channels before the chunks, messages without chunks, chunks of other compressions and sizes, records
of their own, and no summary: all of it is read. What contradicts itself is an error, never a guess.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Message, Metadata, MetadataIndex

from mart.episodes.chunks import UnpackingBudget, unpack
from mart.episodes.scan import BoundedFile, FoundRecord, crc_of, parse, walk
from mart.episodes.summary import FileSummary, read_summary
from mart.protocol.recording import CHECKSUMS, MAX_METADATA_BYTES, metadata_checksum

_MAX_METADATA_RECORDS = 8  # of the largest size; more of smaller ones
_OURS = "mart."  # how the names of our own records begin
_OF_MESSAGES = (Opcode.CHANNEL, Opcode.CHUNK, Opcode.MESSAGE)


def read_messages(file: BoundedFile, finished: bool) -> Iterator[tuple[Channel, Message]]:
    """Iterate over all messages with their channels, in the order of the file.

    finished: whether the file must be whole; it may be cut off anywhere otherwise.
    Raises one of `SYMPTOMS`, also where a finished file holds another number of messages than it says.
    """
    summary = read_summary(file) if finished else FileSummary()
    channels, count = dict(summary.channels), 0
    for record in _of_messages(file, finished):
        if isinstance(record, Channel):
            if channels.setdefault(record.id, record) != record:
                raise ValueError(f"it describes channel {record.id} in two ways")
        elif record.channel_id in channels:
            count += 1
            yield channels[record.channel_id], record
        else:
            raise ValueError(f"it describes channel {record.channel_id} of a message nowhere before it")
    if summary.statistics is not None and count != summary.statistics.message_count:
        raise ValueError(f"it holds {count} messages and says {summary.statistics.message_count}")


def read_metadata(file: BoundedFile, finished: bool) -> Mapping[str, Mapping[str, str]]:
    """Return the metadata records by name; the last one where several of a name are written.

    Records above `MAX_METADATA_BYTES`, which are none of ours, are left out. Raises one of `SYMPTOMS`, also where two
    of our own records of a name contradict each other (a later one may know more), or one does not have its checksum.
    """
    found: dict[str, Mapping[str, str]] = {}
    checksums: dict[str, str] = {}
    left_bytes = _MAX_METADATA_RECORDS * MAX_METADATA_BYTES
    for place in _metadata_places(file, finished):
        if place.size_bytes > MAX_METADATA_BYTES:
            continue
        left_bytes -= place.size_bytes
        if left_bytes < 0:
            raise ValueError(
                f"it holds more metadata than {_MAX_METADATA_RECORDS * MAX_METADATA_BYTES} bytes"
            )
        record = parse(file, place)
        assert isinstance(record, Metadata)
        if record.name == CHECKSUMS:  # those of what is known when a file begins, and all when it ends
            checksums |= record.metadata
            continue
        before = found.get(record.name, {})
        if record.name.startswith(_OURS) and not before.items() <= record.metadata.items():
            raise ValueError(f"it holds two records {record.name} that differ, as if of two episodes")
        found[record.name] = record.metadata
    for name, checksum in checksums.items():
        if name not in found or metadata_checksum(found[name]) != checksum:
            raise ValueError(f"its record {name[:64]} is not what was written")
    return found


def read_attachments(file: BoundedFile, finished: bool) -> Iterator[Attachment]:
    """Iterate over the attachments, each with its checksum checked. Raises one of `SYMPTOMS`."""
    for place in _until_cut(walk(file), finished):
        if place.opcode == Opcode.ATTACHMENT:
            record = parse(file, place)
            assert isinstance(record, Attachment)
            yield record


def require_intact_data(file: BoundedFile) -> None:
    """Check all that stands before the summary of a finished file, heads and metadata too, by its one checksum.

    Raises one of `SYMPTOMS` where it does not match, or where the end of the data is not marked; a checksum of 0 means
    that the writer gave none.
    """
    for place in walk(file):
        if place.opcode == Opcode.DATA_END:
            end = parse(file, place)
            assert isinstance(end, DataEnd)
            if end.data_section_crc and crc_of(file, 0, place.at) != end.data_section_crc:
                raise ValueError("its data section does not match its checksum")
            return
    raise ValueError("the end of its data section is not marked")


def _of_messages(file: BoundedFile, finished: bool) -> Iterator[Channel | Message]:
    """Iterate over channels and messages, also those in chunks, up to the end of the data."""
    budget = UnpackingBudget(file.size)
    for place in _until_cut(walk(file), finished):
        if place.opcode == Opcode.DATA_END:
            return
        record = parse(file, place) if place.opcode in _OF_MESSAGES else None
        if isinstance(record, Chunk):
            yield from (inner for inner in unpack(record, budget) if isinstance(inner, Channel | Message))
        elif isinstance(record, Message):
            budget.spend_message()
            yield record
        elif isinstance(record, Channel):
            yield record


def _metadata_places(file: BoundedFile, finished: bool) -> Iterator[FoundRecord]:
    """Find the metadata records: by the index of a finished file where it names all of them, else one after another."""
    summary = read_summary(file) if finished else FileSummary()
    statistics = summary.statistics
    if statistics is not None and statistics.metadata_count == len(summary.metadata):
        yield from (_indexed(file, index) for index in summary.metadata)
        return
    yield from (place for place in _until_cut(walk(file), finished) if place.opcode == Opcode.METADATA)


def _indexed(file: BoundedFile, index: MetadataIndex) -> FoundRecord:
    place = next(walk(file, index.offset))
    if place.opcode != Opcode.METADATA or place.end - place.at != index.length:
        raise ValueError(f"there is no metadata record {index.name[:64]!r} where its index says")
    return place


def _until_cut(found: Iterator[FoundRecord], finished: bool) -> Iterator[FoundRecord]:
    """Pass records on. A file that is not finished ends where it was cut; any other must not."""
    try:
        yield from found
    except EndOfFile:
        if finished:
            raise
