"""Run one step as a process of its own, which dies with this one."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Protocol

from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.runtime.child_process import MART, start_child, stop_child
from mart.runtime.step_record import LOGS, PlannedStep

_STOP_TIMEOUT_S = 60.0  # a training writes what it needs to go on
_IN_FOLDER = "import os, sys; os.chdir(sys.argv[1]); os.execv(sys.argv[2], sys.argv[2:])"
_TAIL_BYTES = 4096


class RunningStep(Protocol):
    """A step that was started."""

    step: PlannedStep

    @property
    def ended(self) -> bool:
        """Whether it has ended."""
        ...

    def stop(self) -> None:
        """Ask it to end, and wait for it."""
        ...

    def finish(self) -> tuple[int, str]:
        """Return, after its end, its exit code and its last words where it did not succeed."""
        ...


@dataclass
class StepProcess:
    """The process of a step. What it prints on standard output goes to `_printed`, and both streams to its log."""

    step: PlannedStep
    _folder: Path
    _process: subprocess.Popen[bytes]
    _log: Path
    _printed: Path

    @classmethod
    def start(cls, folder: Path, step: PlannedStep, jobs: int) -> StepProcess:
        """Start a step's command in the folder, with its share of the cores where several run."""
        log = folder / LOGS / f"{step.name}.log"
        log.parent.mkdir(parents=True, exist_ok=True)
        printed = log.with_suffix(".out")
        threads = max(1, (os.cpu_count() or 1) // jobs)
        with log.open("ab") as stream, printed.open("wb") as output:
            stream.write(f"$ mart {' '.join(step.command)}\n".encode())
            stream.flush()
            process = _start(folder, step, stream, output, {"OMP_NUM_THREADS": str(threads)})
        return cls(step, folder, process, log, printed)

    @property
    def ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def stop(self) -> None:
        """Ask the process to end, and wait for it."""
        stop_child(self._process, _STOP_TIMEOUT_S)

    def finish(self) -> tuple[int, str]:
        """Keep what the ended process made; return its exit code, and its last words where it did not succeed."""
        code = self._process.wait()
        printed = self._printed.read_bytes()
        if code == 0 and self.step.stdout:
            write_atomically(self._folder / self.step.result, printed, PUBLIC)
        with self._log.open("ab") as log:
            log.write(printed)
        with contextlib.suppress(OSError):
            self._printed.unlink()
        return code, "" if code == 0 else _last_line(self._log)


def _start(
    folder: Path, step: PlannedStep, log: IO[bytes], output: IO[bytes], environment: dict[str, str]
) -> subprocess.Popen[bytes]:
    command: tuple[str | Path, ...] = (sys.executable, "-c", _IN_FOLDER, folder, MART, *step.command)
    return start_child(command, log, environment, output=output)


def _last_line(log: Path) -> str:
    with log.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - _TAIL_BYTES))
        lines = file.read().decode(errors="replace").split("\n")
    said = [line.strip() for line in lines if line.strip() and not line.startswith(("$ mart", "{"))]
    return said[-1] if said else ""
