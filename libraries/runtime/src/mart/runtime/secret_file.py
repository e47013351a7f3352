"""Keep secrets in files: made at first use, readable by their owner alone, whole or not there."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from pathlib import Path

from mart.protocol.errors import InvalidInput

_SECRET_BYTES = 32
_OTHERS = stat.S_IRWXG | stat.S_IRWXO


def load_or_create_secret(path: Path) -> bytes:
    """Return the secret at `path`, made at first use with mode 0600, also where several processes ask at once.

    Raises InvalidInput as `load_secret` does.
    """
    if not path.exists():
        _create(path)
    return load_secret(path)


def load_secret(path: Path) -> bytes:
    """Return the secret at `path`.

    Raises InvalidInput where others may read it or it is too short, OSError where it is not there or not ours to read.
    """
    if path.stat().st_mode & _OTHERS:
        raise InvalidInput(f"The secret in {path} can be read by others; make it private: chmod 600 {path}.")
    secret = path.read_text().strip().encode()
    if len(secret) < _SECRET_BYTES:
        raise InvalidInput(
            f"The secret in {path} has {len(secret)} characters; at least {_SECRET_BYTES} are needed: delete the file."
        )
    return secret


def _create(path: Path) -> None:
    """Write a draft that nobody else knows, and link it to its name: whoever is first has made the secret."""
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.{os.getpid()}.{secrets.token_hex(4)}")
    handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    try:
        with os.fdopen(handle, "w") as file:
            file.write(secrets.token_hex(_SECRET_BYTES))
            file.flush()
            os.fsync(file.fileno())
        with contextlib.suppress(FileExistsError):
            path.hardlink_to(draft)
    finally:
        draft.unlink()
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
