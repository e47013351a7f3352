"""Episode files as other tools leave them: the same messages, metadata and attachments, laid out in another way."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import lz4.frame
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, IndexType, Writer

MAGIC = b"\x89MCAP0\r\n"
MANY = 60 * 1024 * 1024  # bytes in a chunk: fewer than a chunk may have


def by_writer(source: Path, target: Path, **options: object) -> Path:
    """What the `mcap` package's own writer makes of a file with these options."""
    with source.open("rb") as stream, target.open("wb") as out:
        writer = Writer(out, **options)  # type: ignore[arg-type]
        writer.start(profile="mart")
        reader = make_reader(stream)
        schemas: dict[int, int] = {}
        channels: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            if schema.id not in schemas:
                schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
            if channel.id not in channels:
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, schemas[schema.id]
                )
            times = message.log_time, message.data, message.publish_time, message.sequence
            writer.add_message(channels[channel.id], *times)
        for attachment in reader.iter_attachments():
            writer.add_attachment(
                attachment.create_time,
                attachment.log_time,
                attachment.name,
                attachment.media_type,
                attachment.data,
            )
        for metadata in reader.iter_metadata():
            writer.add_metadata(metadata.name, metadata.metadata)
        writer.finish()  # type: ignore[no-untyped-call]
    return target


def packed(records: list[McapRecord]) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


def channels_outside_chunks(source: Path, target: Path) -> Path:
    """All channels before the first chunk, none in any; records of another tool between; no end but the footer."""
    data, described, inside = list[McapRecord](), dict[tuple[type, int], McapRecord](), list[McapRecord]()
    with source.open("rb") as stream:
        for record in StreamReader(stream).records:
            if type(record).__name__ == "DataEnd":
                break
            if isinstance(record, Schema | Channel):
                described[type(record), record.id] = record
            elif isinstance(record, Message):
                inside.append(record)
            elif type(record).__name__ in ("Header", "Metadata", "Attachment"):
                data.append(record)
    half = len(inside) // 2
    content = packed(data) + unknown(0x90) + packed(list(described.values()))
    content += chunk(packed(inside[:half])) + unknown(0xFE) + chunk(packed(inside[half:]), "lz4")
    target.write_bytes(MAGIC + content + data_end() + footer() + MAGIC)
    return target


def unknown(opcode: int) -> bytes:
    return struct.pack("<BQ", opcode, 5) + b"other"


def data_end() -> bytes:
    return struct.pack("<BQI", Opcode.DATA_END, 4, 0)


def footer() -> bytes:
    return struct.pack("<BQQQI", Opcode.FOOTER, 20, 0, 0, 0)


def head(profile: str = "mart") -> bytes:
    return (
        MAGIC
        + struct.pack("<BQI", Opcode.HEADER, 8 + len(profile), len(profile))
        + profile.encode()
        + bytes(4)
    )


def chunk(content: bytes, compression: str = "zstd", said: int | None = None) -> bytes:
    data = zstandard.compress(content) if compression == "zstd" else lz4.frame.compress(content)
    size = len(content) if said is None else said
    return packed([Chunk(compression, data, 0, 0, zlib.crc32(content), size)])


def hostile_files(folder: Path) -> Iterator[Path]:
    """Small files that ask for much."""
    message = struct.pack("<BQ", Opcode.MESSAGE, 22) + bytes(22)
    contents: dict[str, Callable[[], bytes]] = {
        "gigabytes": lambda: chunk(bytes(200 * 1024 * 1024)),
        "says-little": lambda: chunk(bytes(200 * 1024 * 1024), said=1000),
        "says-much": lambda: chunk(b"", said=2**63),
        "lz4-says-little": lambda: chunk(bytes(100 * 1024 * 1024), "lz4", said=1000),
        "messages": lambda: chunk(message * (MANY // len(message))) * 3,
        "zeros": lambda: chunk(bytes(MANY)) * 40,
    }
    for name, make in contents.items():
        path = folder / f"{name}.mcap"
        path.write_bytes(head() + make() + data_end() + footer() + MAGIC)
        yield path


LAYOUTS: dict[str, Callable[[Path, Path], Path]] = {
    "lz4": lambda source, target: by_writer(source, target, compression=CompressionType.LZ4),
    "unpacked": lambda source, target: by_writer(source, target, compression=CompressionType.NONE),
    "unchunked": lambda source, target: by_writer(source, target, use_chunking=False),
    "one-chunk": lambda source, target: by_writer(source, target, chunk_size=2**30),
    "many-chunks": lambda source, target: by_writer(source, target, chunk_size=1),
    "no-index": lambda source, target: by_writer(source, target, index_types=IndexType.NONE),
    "no-summary": lambda source, target: by_writer(
        source, target, index_types=IndexType.NONE, use_statistics=False, repeat_channels=False,
        repeat_schemas=False, use_summary_offsets=False,
    ),
    "no-checksums": lambda source, target: by_writer(source, target, enable_crcs=False),
    "data-checksum": lambda source, target: by_writer(source, target, enable_data_crcs=True),
    "outside-chunks": channels_outside_chunks,
}  # fmt: skip
