"""Let one platform at a time have a data folder, and tell who has it.

The claim is a locked file in the platform's run folder, which the kernel unlocks when its holder ends, however it ends.
In it stands who holds it; what a killed holder has left running is ended by whoever comes next.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import logging
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from mart.platform.run.platform_processes import end_processes, processes_of
from mart.protocol.errors import Conflict, Unavailable

_log = logging.getLogger(__name__)

_FILE = "claim.json"
_LEFTOVER_PATIENCE_S = 40.0  # a recorder that is verifying gets 30 s to close its file


@dataclass(frozen=True)
class ClaimHolder:
    """Who has the data folder `folder`.

    mark: what its processes carry. url: of its pages, empty where it has none.
    """

    pid: int
    folder: str
    mark: str
    url: str

    def in_words(self) -> str:
        """Return "process 7 at https://…"."""
        return f"process {self.pid} at {self.url}" if self.url else f"process {self.pid}"


@contextlib.contextmanager
def claimed(run_dir: Path, holder: ClaimHolder) -> Iterator[None]:
    """Hold the claim while the block runs; first ends what a killed platform left running.

    Raises Conflict where another holds it, and Unavailable where the folder cannot be written.
    """
    try:
        run_dir.mkdir(parents=True, exist_ok=True)
        handle = os.open(run_dir / _FILE, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        raise Unavailable(
            f"{run_dir} cannot be written ({error.strerror}); mend it, or name another data folder."
        ) from error
    with os.fdopen(handle, "r+b") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise Conflict(_taken(holder.folder, _read(file.read()))) from error
        _end_leftovers(_read(file.read()))
        _write(file.fileno(), json.dumps(asdict(holder)).encode())
        try:
            yield
        finally:
            _write(file.fileno(), b"")


def claim_holder(run_dir: Path) -> ClaimHolder | None:
    """Return who holds the claim now; None where nobody does."""
    with contextlib.suppress(FileNotFoundError), (run_dir / _FILE).open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            return _read(file.read())
    return None


def leftovers_of(run_dir: Path) -> ClaimHolder | None:
    """Return the holder that was killed and whose processes still run; None where there is none."""
    try:
        holder = _read((run_dir / _FILE).read_bytes())
    except FileNotFoundError:
        return None
    return holder if holder is not None and processes_of(holder.mark) else None


def _taken(folder: str, holder: ClaimHolder | None) -> str:
    who = holder.in_words() if holder is not None else "a process that is just starting"
    return (
        f"The data folder {folder} is in use by {who}. `MART_DATA_DIR={folder} mart stop` stops that; "
        "or name another folder."
    )


def _end_leftovers(before: ClaimHolder | None) -> None:
    if before is None or not (left := processes_of(before.mark)):
        return
    _log.warning("Process %d was killed; waiting for the %d that it left", before.pid, len(left))
    end_processes(before.mark, _LEFTOVER_PATIENCE_S)


def _read(content: bytes) -> ClaimHolder | None:
    try:
        return ClaimHolder(**json.loads(content))
    except (ValueError, TypeError):  # empty, or written half
        return None


def _write(handle: int, content: bytes) -> None:
    os.ftruncate(handle, 0)
    os.pwrite(handle, content, 0)
