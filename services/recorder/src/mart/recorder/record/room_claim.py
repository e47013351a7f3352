"""Let one recorder at a time record a room into a folder of episodes.

Two platforms may write into one folder, with rooms of their own; two recorders of one room would write each episode
twice.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
from pathlib import Path

_FOLDER = ".recorders"


class RoomClaim:
    """Hold the right to record a room until it is released; the kernel lets go of it when this process ends."""

    def __init__(self, path: Path, handle: int) -> None:
        self._path, self._handle = path, handle

    def release(self) -> None:
        """Let another recorder have the room."""
        with contextlib.suppress(OSError):
            self._path.unlink()
        os.close(self._handle)


def claim_room(root: Path, room: str) -> RoomClaim | None:
    """Return the claim of a room, None where another recorder holds it. Raises OSError where `root` is not writable."""
    path = root / _FOLDER / f"{room}.lock"
    path.parent.mkdir(parents=True, exist_ok=True)
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            return None
        if os.fstat(handle).st_nlink:
            return RoomClaim(path, handle)
        os.close(handle)  # it was released, and its file taken away, between the two
