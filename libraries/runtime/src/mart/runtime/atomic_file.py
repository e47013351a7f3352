"""Replace files in one step: a reader, or a crash, finds the old content or the new one, never half of it."""

from __future__ import annotations

import errno
import os
from pathlib import Path

PRIVATE = 0o600  # secrets, and what names people
PUBLIC = 0o644
_NO_LINKS = (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK)  # of file systems without hard links


def write_atomically(path: Path, content: bytes, mode: int = PRIVATE) -> None:
    """Replace the file at `path` by `content` with this mode, synced to the disk; a missing folder is made.

    The folder is synced too: after a power cut the new content is there, not the one before.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    draft.unlink(missing_ok=True)
    handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
    with os.fdopen(handle, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    draft.replace(path)
    sync_folder(path.parent)


def rename_to_new(source: Path, target: Path) -> None:
    """Give a file a name that nothing has, whoever else tries the same: nothing is ever overwritten.

    Raises FileExistsError where the name is taken. A crash in between leaves the file with both names.
    """
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
        if os.path.lexists(target):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target)) from error
        source.rename(target)
    else:
        source.unlink()


def sync_folder(folder: Path) -> None:
    """Bring the names in a folder onto the disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
