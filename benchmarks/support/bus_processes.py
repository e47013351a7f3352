"""Run processes beside a benchmark, and wait until they are on the bus."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

from mart.runtime.bus import Bus


@contextlib.contextmanager
def child(*command: str, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a command for the length of the block; the word `mart` is this environment's."""
    program = str(Path(sys.executable).with_name(command[0])) if command[0] == "mart" else command[0]
    process = subprocess.Popen([program, *command[1:]], env={**os.environ, **environment})
    try:
        yield process
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait()


def await_alive(bus: Bus, key: str, timeout_s: float = 30.0) -> None:
    """Wait for a liveliness key; a benchmark without it ends."""
    alive = threading.Event()
    with contextlib.closing(bus.watch(key, lambda _, present: alive.set() if present else None)):
        if not alive.wait(timeout_s):
            raise SystemExit(f"{key} did not come up within {timeout_s:g} s")
