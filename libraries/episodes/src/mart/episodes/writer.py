"""Write one episode's MCAP file: stock `mcap`, small chunks, on the disk whenever it is flushed."""

from __future__ import annotations

import errno
import fcntl
import os
from collections.abc import Mapping
from pathlib import Path
from typing import IO, cast

from google.protobuf.message import Message
from mcap.well_known import MessageEncoding
from mcap.writer import CompressionType, Writer
from mcap_protobuf.schema import register_schema

from mart.episodes.mcap_entries import McapEntry
from mart.episodes.patient_file import PatientFile
from mart.protocol.messages import Model
from mart.protocol.recording import (
    CHECKSUMS,
    MODEL_ATTACHMENT,
    PROFILE,
    TASK_ATTACHMENT,
    RoomRecord,
    metadata_checksum,
)
from mart.runtime.atomic_file import rename_to_new

_CHUNK_BYTES = 256 * 1024  # what one damaged sector can cost


class EpisodeWriter:
    """Write an episode file, which is this object's own until `move_to`, `abandon` or `discard`.

    Every method may raise OSError: the disk is broken, or has been full for too long (`PatientFile`). The path is
    locked meanwhile, so that a repair leaves it alone; a lock dies with its process.
    """

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self.messages = 0
        self._description: Mapping[str, str] = {}
        self.has_model = False
        opening = path.with_name(f".{path.name}.opening")  # a repair must not find it before it is locked
        self._file = PatientFile(opening)
        self._lock = opening.open("rb")
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        rename_to_new(opening, path)
        self._is_finished = False
        self._mcap = Writer(
            cast("IO[bytes]", self._file),
            chunk_size=_CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            enable_data_crcs=True,
        )
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._checksums: dict[str, str] = {}
        self._mcap.start(profile=PROFILE)

    def add(self, entry: McapEntry) -> None:
        """Append one message; its topic and schema are described in the file when they first come."""
        channel = self._channels.get(entry.topic)
        if channel is None:
            channel = self._channel(entry.topic, entry.schema)
        self._mcap.add_message(channel, entry.arrived_ns, entry.payload, entry.sent_ns, entry.sequence)
        self.messages += 1

    def describe(self, record: RoomRecord) -> None:
        """Say of what room this file is, once that is known, and again when more is known: the last word holds.

        A record that knows no more than the one before says nothing. The checksum of one that stands follows at once,
        since the file may be cut short.
        """
        strings = record.to_strings()
        if not self._description or not strings.items() <= self._description.items():
            self._description = strings
            self.add_record(record.NAME, strings)
            self._mcap.add_metadata(CHECKSUMS, self._checksums)

    def attach_model(self, model: Model, now_ns: int) -> None:
        """Attach the compiled MuJoCo model, and the task file of a task that is somebody's own. now_ns: Unix time."""
        self.has_model = True
        if model.task_file:
            self._mcap.add_attachment(now_ns, now_ns, TASK_ATTACHMENT, "application/toml", model.task_file)
        self._mcap.add_attachment(now_ns, now_ns, MODEL_ATTACHMENT, "application/octet-stream", model.mjb)

    def add_record(self, name: str, strings: Mapping[str, str]) -> None:
        """Write one metadata record."""
        self._mcap.add_metadata(name, dict(strings))
        self._checksums[name] = metadata_checksum(strings)

    def flush(self) -> None:
        """Bring everything so far onto the disk: a kill or a power cut takes nothing of it afterwards.

        Raises OSError for want of room, too; then `waits`, and it goes on.
        """
        self._mcap.flush()  # type: ignore[no-untyped-call]
        self._file.sync()

    @property
    def waits(self) -> bool:
        """Whether anything waits in memory for room on the disk."""
        return self._file.waiting_bytes > 0

    def require_there(self) -> None:
        """Raise FileNotFoundError where somebody has deleted the file: what is written would be lost."""
        if not os.fstat(self._file.fileno()).st_nlink:
            raise FileNotFoundError(errno.ENOENT, "its file was deleted", str(self.path))

    def finish(self) -> None:
        """Write the checksums of the metadata and the summary, and close the file, which stays locked.

        May be called again after it has failed for want of room.
        """
        if not self._is_finished:
            self._is_finished = True
            self._mcap.add_metadata(CHECKSUMS, self._checksums)
            self._mcap.finish()  # type: ignore[no-untyped-call]
        self._file.sync()
        self._file.close()

    def move_to(self, path: Path) -> None:
        """Give the finished file its name, for good also across a power cut. Raises FileExistsError if it is taken."""
        path.parent.mkdir(parents=True, exist_ok=True)
        if path != self.path:
            rename_to_new(self.path, path)
        self.path = path
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
            self._lock.close()

    def abandon(self) -> None:
        """Close the file as it is: what reached the disk stays there for a repair."""
        self._file.close()
        self._lock.close()

    def _channel(self, topic: str, schema: type[Message]) -> int:
        name = schema.DESCRIPTOR.full_name
        if name not in self._schemas:
            self._schemas[name] = register_schema(self._mcap, schema)
        self._channels[topic] = self._mcap.register_channel(
            topic, MessageEncoding.Protobuf, self._schemas[name]
        )
        return self._channels[topic]

    def discard(self) -> None:
        """Take the file away: there was nothing to record."""
        self.abandon()
        self.path.unlink()
