"""Tell files apart by what is in them."""

from __future__ import annotations

import hashlib
from pathlib import Path

from mart.protocol.errors import NotFound


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal, read in pieces. Raises NotFound where none is."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise NotFound(f"{path} cannot be read: {error}.") from error
