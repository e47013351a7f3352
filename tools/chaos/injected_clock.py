"""Set the wall clock of the platform's processes, and of no other: a library before the C library (LD_PRELOAD)."""

from __future__ import annotations

import shutil
import struct
import subprocess
from pathlib import Path

_SOURCE = Path(__file__).with_name("wall_clock.c")


class InjectedClock:
    """A wall clock that can be set; `environment` is what its processes are started with.

    Without a C compiler there is none: `environment` is empty, and `set` raises RuntimeError.
    """

    def __init__(self, folder: Path) -> None:
        self._offset = folder / "clock-offset"
        self._library = folder / "wall_clock.so"
        self._offset.write_bytes(struct.pack("=q", 0))
        compiler = shutil.which("cc")
        self.is_there = compiler is not None
        if compiler is not None:
            command = [compiler, "-shared", "-fPIC", "-O2", "-o", str(self._library), str(_SOURCE), "-ldl"]
            subprocess.run(command, check=True)

    @property
    def environment(self) -> dict[str, str]:
        """What a process is started with, so that this is its clock."""
        if not self.is_there:
            return {}
        return {"LD_PRELOAD": str(self._library), "CHAOS_CLOCK": str(self._offset)}

    def set(self, offset_s: float) -> None:
        """Let the clock differ from the machine's by so much, from now on."""
        with self._offset.open("r+b") as file:
            file.write(struct.pack("=q", round(offset_s * 1e9)))
