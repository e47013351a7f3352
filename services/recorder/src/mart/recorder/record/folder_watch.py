"""Know whether a folder takes what is written into it, before a write fails: its disk is full, or read-only."""

from __future__ import annotations

import os
from pathlib import Path

_FULL_BYTES = 256 * 1024  # less than a chunk of a file


class FolderWatch:
    """Look at a folder again and again; say what is new."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._trouble = ""

    def news(self) -> tuple[str, str] | None:
        """Return, once, what people are to be told now: the level of a notice and its text."""
        trouble = trouble_of(self._folder)
        if trouble == self._trouble:
            return None
        self._trouble = trouble
        if trouble:
            return "error", f"{trouble}: what is recorded waits in memory, for minutes at most. Make room."
        return "info", "What waited for room on the recorder's disk is being written."


def trouble_of(folder: Path) -> str:
    """Say in words what keeps files from being written below `folder`; "" where nothing does, or nobody can tell."""
    try:
        found = os.statvfs(folder)
    except OSError:
        return ""
    if found.f_flag & os.ST_RDONLY:
        return "The recorder's folder is read-only"
    free = found.f_bavail if os.geteuid() else found.f_bfree  # root may use what is reserved
    return "The recorder's disk is full" if free * found.f_frsize < _FULL_BYTES else ""
