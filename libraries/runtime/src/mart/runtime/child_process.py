"""Start commands that end with the process that started them, also where that one is killed.

`python -m mart.runtime.child_process PARENT SIGNAL COMMAND …` asks the kernel for it and becomes COMMAND (Linux:
prctl(2), PR_SET_PDEATHSIG). The kernel means the thread that started it: start from one that lives as long as it
should.
"""

from __future__ import annotations

import ctypes
import io
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO

_PR_SET_PDEATHSIG = 1
_STOP_TIMEOUT_S = 10.0

MART = Path(sys.executable).with_name("mart")
STANDARD_ERROR = io.FileIO(
    2, "w", closefd=False
)  # as a log: this process's own, whatever `sys.stderr` is now


def start_child(
    command: Sequence[str | Path],
    log: IO[bytes],
    environment: Mapping[str, str],
    *,
    piped: bool = False,
    output: IO[bytes] | None = None,
    death_signal: signal.Signals = signal.SIGKILL,
) -> subprocess.Popen[bytes]:
    """Start a command that dies with this process, in a process group of its own.

    environment: goes on top of ours. log: takes its output; where it is `piped`, standard input and output are pipes
    and only errors go there. output: takes standard output in place of the log. death_signal: what it is sent when this
    process dies; one that has something to put in order gets SIGTERM.
    """
    bound = [sys.executable, "-m", __name__, str(os.getpid()), str(int(death_signal)), *map(str, command)]
    return subprocess.Popen(  # noqa: S603 - our own command, from our own environment
        bound,
        env={**os.environ, **environment},
        stdin=subprocess.PIPE if piped else subprocess.DEVNULL,
        stdout=subprocess.PIPE if piped else output or log,
        stderr=log,
        start_new_session=True,
    )


def stop_child(process: subprocess.Popen[bytes], timeout_s: float = _STOP_TIMEOUT_S) -> None:
    """Ask a child to end, kill it where it does not within `timeout_s`, and wait for it."""
    process.terminate()
    try:
        process.wait(timeout_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _become(parent: int, death_signal: int, command: list[str]) -> None:
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, death_signal)
    if os.getppid() == parent:  # else it died before we could ask
        os.execv(command[0], command)  # noqa: S606 - see start_child


if __name__ == "__main__":
    _become(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:])
