"""Which episode files a command line means."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from mart.protocol.errors import NotFound
from mart.protocol.recording import SUFFIX


def episode_files(paths: Iterable[Path]) -> list[Path]:
    """Every episode file among `paths`: files themselves, folders with all that is in them. Raises NotFound."""
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            found += sorted(path.rglob(f"*{SUFFIX}"))
        elif path.is_file():
            found.append(path)
        else:
            raise NotFound(f"There is no {path}; name episode files or folders of them.")
    return found
