"""Let one recorder at a time write into a folder of episodes."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

from mart.protocol.errors import Conflict

_FILE = ".recorder.lock"


@contextlib.contextmanager
def only_recorder_of(root: Path) -> Iterator[None]:
    """Hold the folder while the block runs; the kernel lets go of it when this process ends, however it ends.

    Raises Conflict where another recorder holds it, and OSError where the folder cannot be written.
    """
    root.mkdir(parents=True, exist_ok=True)
    handle = os.open(root / _FILE, os.O_RDWR | os.O_CREAT, 0o600)
    with os.fdopen(handle, "r+") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            holder = file.read(20).strip() or "unknown"
            raise Conflict(
                f"Another recorder (process {holder}) writes into {root}; stop it, or use another folder."
            ) from error
        file.truncate(0)
        file.write(f"{os.getpid()}\n")
        file.flush()
        yield
