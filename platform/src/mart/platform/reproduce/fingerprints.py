"""Hashes of what steps take and make. What was hashed before, and has not been touched since, is not read again."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from mart.runtime.atomic_file import PUBLIC, write_atomically

_FILE = "hashes.json"
# What of a folder counts: episodes with what people said of them, or a run's request, data and weights.
_COUNTED = ("*.mcap", "labels.jsonl", "run.json", "data.json", "checkpoint.json", "*.safetensors")
_LEFT_OUT = {"resume", "rollouts"}


class Fingerprints:
    """Hash files and folders below `folder`, or elsewhere where their path is absolute."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._cache: dict[str, list[object]] = _read(folder / _FILE)

    def of(self, path: str) -> str:
        """Return the SHA-256 of a file, or of all that counts in a folder; empty where there is nothing."""
        place = self._folder / path
        if place.is_file():
            return self._of_file(place)
        files = sorted(file for file in _files(place) if not _LEFT_OUT & set(file.relative_to(place).parts))
        if not files:
            return ""
        lines = (f"{file.relative_to(place).as_posix()} {self._of_file(file)}\n" for file in files)
        return hashlib.sha256("".join(lines).encode()).hexdigest()

    def keep(self) -> None:
        """Write down what was hashed."""
        write_atomically(self._folder / _FILE, json.dumps(self._cache).encode(), PUBLIC)

    def _of_file(self, file: Path) -> str:
        status = file.stat()
        known = self._cache.get(str(file))
        if known is None or known[:2] != [status.st_size, status.st_mtime_ns]:
            with file.open("rb") as stream:
                digest = hashlib.file_digest(stream, "sha256").hexdigest()
            known = self._cache[str(file)] = [status.st_size, status.st_mtime_ns, digest]
        return str(known[2])


def _files(folder: Path) -> list[Path]:
    return [file for pattern in _COUNTED for file in folder.rglob(pattern) if file.is_file()]


def _read(path: Path) -> dict[str, list[object]]:
    try:
        found = json.loads(path.read_bytes())
    except (OSError, ValueError):  # it is derived: what is missing is hashed anew
        return {}
    return found if isinstance(found, dict) else {}
