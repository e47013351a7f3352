"""Find the processes of a platform, whoever started them, and end them. Linux: reads /proc.

Each carries the platform's mark in its environment, and hands it on to whatever it starts: so also what a killed parent
has left behind is found.
"""

from __future__ import annotations

import contextlib
import os
import signal
from pathlib import Path

from mart.protocol import clock

MARK = "MART_PLATFORM"
_LOOK_EVERY_S = 0.1


def environment_of(pid: int) -> dict[str, str]:
    """Return what a process was started with; empty where it has ended or belongs to somebody else."""
    try:
        content = Path(f"/proc/{pid}/environ").read_bytes()
    except OSError:
        return {}
    pairs = (entry.partition("=") for entry in content.decode(errors="replace").split("\0") if entry)
    return {name: value for name, _, value in pairs}


def command_of(pid: int) -> str:
    """Return a process's command in words: `mart web`; empty where it has ended."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return ""
    names = [Path(word).name for word in words if word]
    start = next((number for number, name in enumerate(names) if name == "mart"), 0)
    return " ".join(names[start : start + 2])


def processes_of(mark: str) -> list[int]:
    """Return the ids of the processes that carry a platform's mark, in ascending order."""
    pids = (int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdigit())
    return sorted(pid for pid in pids if environment_of(pid).get(MARK) == mark)


def end_processes(mark: str, patience_s: float) -> list[int]:
    """Wait until no process carries the mark, and kill those that stay for longer than `patience_s`.

    Returns the ids of the killed.
    """
    deadline_s = clock.monotonic_s() + patience_s
    while (left := processes_of(mark)) and clock.monotonic_s() < deadline_s:
        clock.sleep_s(_LOOK_EVERY_S)
    for pid in left:
        with contextlib.suppress(ProcessLookupError):  # it ended just now
            os.kill(pid, signal.SIGKILL)
    while processes_of(mark):
        clock.sleep_s(_LOOK_EVERY_S)
    return left


def listener_of(port: int) -> int | None:
    """Return the id of the process of ours that listens at a TCP port; None where none is found."""
    sockets = {
        f"socket:[{inode}]"
        for table in ("tcp", "tcp6")
        for inode in _listening(Path("/proc/net") / table, port)
    }
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and sockets & _open_files(entry):
            return int(entry.name)
    return None


def _listening(table: Path, port: int) -> list[str]:
    """Of /proc/net/tcp (proc(5)): the inodes of sockets that listen at this port."""
    try:
        rows = [line.split() for line in table.read_text().splitlines()[1:]]
    except OSError:
        return []
    return [row[9] for row in rows if row[3] == "0A" and int(row[1].rpartition(":")[2], 16) == port]


def _open_files(process: Path) -> set[str]:
    found = set()
    with contextlib.suppress(OSError):  # ended, or somebody else's
        for handle in (process / "fd").iterdir():
            with contextlib.suppress(OSError):
                found.add(os.readlink(handle))
    return found
