"""How much of a core the processes of a platform take, by what they are. Linux: reads /proc.

Time on a core does not grow where others want the cores too, so a busy machine says nearly the same as a quiet one.
"""

from __future__ import annotations

import os
import time
from collections import defaultdict
from pathlib import Path

from mart.platform.run.platform_processes import MARK, environment_of, processes_of

_TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def cores_taken(seconds: float) -> dict[str, float]:
    """Watch the services of the platform that this process runs, for so long.

    Returns the cores that each kind took, and all together as `all`.
    """
    before = _used_s()
    begun_s = time.monotonic()
    time.sleep(seconds)
    after, took_s = _used_s(), time.monotonic() - begun_s
    cores: defaultdict[str, float] = defaultdict(float)
    for pid, (kind, used_s) in after.items():
        if pid in before:
            cores[kind] += (used_s - before[pid][1]) / took_s
    return {"all": sum(cores.values()), **cores}


def _used_s() -> dict[int, tuple[str, float]]:
    """By process: what it is, and the seconds on a core that it has used."""
    used = {}
    for pid in processes_of(_mark()):
        try:
            stat = Path(f"/proc/{pid}/stat").read_text()
            words = Path(f"/proc/{pid}/cmdline").read_text().split("\0")
        except OSError:  # it has ended
            continue
        user, system = stat.rpartition(")")[2].split()[11:13]
        used[pid] = (_kind(words), (int(user) + int(system)) / _TICKS_PER_S)
    return used


def _kind(words: list[str]) -> str:
    if "mart.teleop_gateway.process.seat_process" in words:
        return "seat"
    names = [Path(word).name for word in words if word]
    at = next((number for number, name in enumerate(names) if name == "mart"), -1)
    return names[at + 1] if 0 <= at < len(names) - 1 else "supervisor"


def _mark() -> str:
    """The mark that this process has given the platform that it runs."""
    children = [
        pid for task in Path("/proc/self/task").iterdir() for pid in (task / "children").read_text().split()
    ]
    return next(mark for pid in children if (mark := environment_of(int(pid)).get(MARK)))
