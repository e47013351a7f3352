"""What the queue asks of a place where jobs run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol


@dataclass(frozen=True)
class JobEnded:
    """code: see job.End. why: in words, where it was not done."""

    job: int
    code: int
    why: str = ""


OnEnded = Callable[[JobEnded], None]  # from any thread, once for each start


class Executor(Protocol):
    @property
    def slots(self) -> int:
        """How many jobs it takes at a time now; 0 while it cannot be reached."""
        ...

    @property
    def trouble(self) -> str:
        """Why it takes none, in words for those who wait; empty where it does."""
        ...

    def start(self, job: int, run: Path) -> None:
        """Runs `mart.trainer.jobs.worker` on the folder `run`."""
        ...

    def stop(self, job: int) -> None:
        """Asks a job to end soon; it is told of as any other end."""
        ...

    def close(self) -> None:
        """Ends everything that runs."""
        ...
