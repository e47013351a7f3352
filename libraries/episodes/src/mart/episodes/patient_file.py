"""A file for a disk that may be full for a while: what it does not take waits in memory, in order, up to a bound."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from mart.protocol import clock

Result = TypeVar("Result")

MOST_WAITING_BYTES = 64 * 1024 * 1024  # minutes of an episode with its videos
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)  # which people can mend meanwhile
_AGAIN_S = 0.25


class PatientFile:
    """A new file, to be written from its beginning to its end.

    A disk without room fails no write until `most_waiting_bytes` wait; then, and for every other reason, OSError.
    """

    def __init__(self, path: Path, most_waiting_bytes: int = MOST_WAITING_BYTES) -> None:
        self._file = path.open("wb", buffering=0)
        self._most_waiting_bytes = most_waiting_bytes
        self._waiting = bytearray()
        self._written_bytes = 0

    @property
    def waiting_bytes(self) -> int:
        """How much waits in memory for room."""
        return len(self._waiting)

    def write(self, data: bytes) -> int:
        """Append `data`, behind what waits."""
        has_place = len(self._waiting) + len(data) <= self._most_waiting_bytes
        self._waiting += data
        try:
            self._drain()
        except OSError as error:
            if not (has_place and is_for_want_of_room(error)):
                raise
        return len(data)

    def tell(self) -> int:
        """Return where the next byte belongs, once there is room for all before it."""
        return self._written_bytes + len(self._waiting)

    def flush(self) -> None:
        """Do nothing: `sync` brings everything onto the disk, and says where that fails."""

    def sync(self) -> None:
        """Bring everything onto the disk. Raises OSError where there is no room; what waits goes on waiting."""
        self._drain()
        os.fsync(self._file.fileno())

    def fileno(self) -> int:
        """Return the file's descriptor."""
        return self._file.fileno()

    def close(self) -> None:
        """Close the file; what still waits is lost."""
        self._file.close()

    def _drain(self) -> None:
        while self._waiting:
            written = self._file.write(self._waiting) or 0
            del self._waiting[:written]
            self._written_bytes += written


def is_for_want_of_room(error: Exception) -> bool:
    """Whether an error says that a disk is full, or read-only: it is worth trying again."""
    return isinstance(error, OSError) and error.errno in _NO_ROOM


def patiently(call: Callable[[], Result], patience_s: float) -> Result:
    """Call again as long as there is no room, for at most `patience_s`; then the error is raised."""
    deadline_s = clock.monotonic_s() + patience_s
    while True:
        try:
            return call()
        except OSError as error:
            if not is_for_want_of_room(error) or clock.monotonic_s() >= deadline_s:
                raise
        clock.sleep_s(_AGAIN_S)
