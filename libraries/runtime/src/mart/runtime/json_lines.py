"""Append lines of JSON to a file and read them back, also where a crash has torn the last one."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from mart.protocol import clock

_TAIL_BYTES = 4096
_MAX_LINE_BYTES = 16 * 1024 * 1024
_PATIENCE_S = 10.0
_RETRY_S = 0.002
_NO_LOCKS = (
    errno.ENOLCK,
    errno.EOPNOTSUPP,
    errno.ENOSYS,
)  # of some network folders: one write goes in one piece


def append_json_line(path: Path, row: Mapping[str, Any]) -> None:
    """Append `row` as one line, synced to the disk; a torn line before it is ended, a missing folder made."""
    append_json_lines(path, [row])


def append_json_lines(path: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Append `rows`, a line each, in one write; like `append_json_line`, but synced once for all."""
    lines = [json_line(row) for row in rows]
    with alone_with(path) as file:
        append_lines(file, lines)


@contextlib.contextmanager
def alone_with(path: Path) -> Iterator[BinaryIO]:
    """Open a file of lines to append to, which nobody else does meanwhile; a missing file or folder is made.

    A torn last line is ended, so what is appended is a line of its own. Raises OSError, also where another process has
    it for ten seconds.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with _locked(path) as file:
        if file.seek(0, os.SEEK_END) > 0:
            file.seek(-1, os.SEEK_END)
            if file.read(1) != b"\n":
                file.write(b"\n")
                file.flush()
        yield file


def append_lines(file: BinaryIO, lines: Iterable[bytes]) -> None:
    """Append lines, given without their ends, in one write; on the disk when this returns."""
    file.write(b"".join(line + b"\n" for line in lines))
    file.flush()
    os.fsync(file.fileno())


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[BinaryIO]:
    until_s = clock.monotonic_s() + _PATIENCE_S
    while True:
        with path.open("ab+") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                if clock.monotonic_s() > until_s:
                    raise
                clock.sleep_s(_RETRY_S)
                continue
            except OSError as error:
                if error.errno not in _NO_LOCKS:
                    raise
            if path.exists() and os.path.samestat(os.fstat(file.fileno()), path.stat()):
                yield file
                return
            # An editor has put another file in its place between the two: that one is meant.


def json_line(row: Mapping[str, Any]) -> bytes:
    """Return `row` as one line, without its end."""
    return json.dumps(row, ensure_ascii=False, separators=(",", ":")).encode()


def read_json_lines(path: Path) -> Iterator[tuple[int, dict[str, Any] | None]]:
    """Yield each line's number, from 1, with its object; None where the line is not one JSON object (torn, foreign).

    Lines above 16 MiB count as foreign, and are not held in memory. Raises OSError where the file cannot be read.
    """
    if not path.exists():
        return
    with path.open("rb") as file:
        for number, line in enumerate(_lines(file), start=1):
            if line.strip():
                yield number, json_object(line)


def read_last_json_line(path: Path) -> dict[str, Any] | None:
    """Return the last line that is one JSON object, of the file's last 4,096 bytes; None where there is none."""
    if not path.exists():
        return None
    with path.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - _TAIL_BYTES))
        lines = file.read().split(b"\n")
    return next((row for line in reversed(lines) if (row := json_object(line)) is not None), None)


def _lines(file: BinaryIO) -> Iterator[bytes]:
    """Yield the lines of a file, the beginning only of one that is too long."""
    while line := file.readline(_MAX_LINE_BYTES):
        yield line
        while not line.endswith(b"\n") and (line := file.readline(_MAX_LINE_BYTES)):
            pass


def json_object(line: bytes) -> dict[str, Any] | None:
    """Return the JSON object of one line; None where it is none (torn, foreign, too long)."""
    if len(line) > _MAX_LINE_BYTES:
        return None
    try:
        row = json.loads(line.decode())
    except (ValueError, RecursionError):
        return None
    return row if isinstance(row, dict) else None
