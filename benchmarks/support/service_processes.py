"""What the services of the platform that this process runs take and hold, by what they are. Linux: reads /proc.

Time on a core does not grow where others want the cores too, so a busy machine says nearly the same as a quiet one.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mart.platform.run.platform_processes import MARK, environment_of, processes_of

_TICKS_PER_S = os.sysconf("SC_CLK_TCK")
_PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 1e6


@dataclass(frozen=True)
class Held:
    """Hold what processes of one kind hold together: resident memory, threads, open files and sockets."""

    memory_mb: float = 0.0
    threads: int = 0
    files: int = 0

    def __add__(self, other: Held) -> Held:
        return Held(self.memory_mb + other.memory_mb, self.threads + other.threads, self.files + other.files)


def cores_taken(seconds: float) -> dict[str, float]:
    """Watch the services for so long; returns the cores that each kind took, and all together as `all`."""
    before = dict(_used_s())
    begun_s = time.monotonic()
    time.sleep(seconds)
    after, took_s = dict(_used_s()), time.monotonic() - begun_s
    cores: defaultdict[str, float] = defaultdict(float)
    for (pid, kind), used_s in after.items():
        if (pid, kind) in before:
            cores[kind] += (used_s - before[pid, kind]) / took_s
    return {"all": sum(cores.values()), **cores}


def held_by_services() -> dict[str, Held]:
    """Return what services hold now, by kind."""
    held: defaultdict[str, Held] = defaultdict(Held)
    for pid, kind in _services():
        with contextlib.suppress(OSError):  # it has ended
            stat = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            files = len(os.listdir(f"/proc/{pid}/fd"))
            held[kind] += Held(int(stat[21]) * _PAGE_MB, int(stat[17]), files)
    return dict(held)


def _used_s() -> Iterator[tuple[tuple[int, str], float]]:
    """By process and kind, the seconds on a core that it has used."""
    for pid, kind in _services():
        with contextlib.suppress(OSError):
            user, system = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
            yield (pid, kind), (int(user) + int(system)) / _TICKS_PER_S


def _services() -> Iterator[tuple[int, str]]:
    for pid in processes_of(_mark()):
        with contextlib.suppress(OSError):
            yield pid, _kind(Path(f"/proc/{pid}/cmdline").read_text().split("\0"))


def _kind(words: list[str]) -> str:
    if "mart.teleop_gateway.process.seat_process" in words:
        return "seat"
    names = [Path(word).name for word in words if word]
    at = next((number for number, name in enumerate(names) if name == "mart"), -1)
    return names[at + 1] if 0 <= at < len(names) - 1 else "supervisor"


def _mark() -> str:
    """The mark that this process has given the platform that it runs."""
    tasks = Path("/proc/self/task").iterdir()
    children = [int(pid) for task in tasks for pid in (task / "children").read_text().split()]
    return next(mark for pid in children if (mark := environment_of(pid).get(MARK)))
