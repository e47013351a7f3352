"""What the queue asks of a place where jobs run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol


@dataclass(frozen=True)
class JobEnded:
    """A job's process has ended. code: see ExitCode. why: in words, where it was not done."""

    job: int
    code: int
    why: str = ""


OnEnded = Callable[[JobEnded], None]  # from any thread, once for each start


class Executor(Protocol):
    """A place where jobs run."""

    @property
    def slots(self) -> int:
        """How many jobs it takes at a time now; 0 while it cannot be reached."""
        ...

    @property
    def trouble(self) -> str:
        """Why it takes none, in words for those who wait; empty where it does."""
        ...

    def start(self, job: int, run: Path) -> None:
        """Run `mart.trainer.jobs.worker` on the folder `run`."""
        ...

    def stop(self, job: int) -> None:
        """Ask a job to end soon; that is told of as any other end."""
        ...

    def close(self) -> None:
        """End everything that runs."""
        ...
