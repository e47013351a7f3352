"""What a job's process is told, and how it says how it ended: files in the run's folder."""

from __future__ import annotations

import signal
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from mart.protocol.errors import Corrupt
from mart.trainer.jobs.job import Judging
from mart.trainer.request import TrainRequest

LOG = "log.txt"
_ORDER = "job.json"
_WHY = "why.txt"


class WorkOrder(BaseModel):
    """Everything that a job's process must know."""

    model_config = ConfigDict(frozen=True)

    request: TrainRequest
    judging: Judging

    def save(self, run: Path) -> None:
        run.mkdir(parents=True, exist_ok=True)
        (run / _ORDER).write_text(self.model_dump_json())
        (run / _WHY).unlink(missing_ok=True)

    @classmethod
    def load(cls, run: Path) -> WorkOrder:
        """Raises Corrupt."""
        path = run / _ORDER
        try:
            return cls.model_validate_json(path.read_bytes())
        except (OSError, ValidationError) as error:
            raise Corrupt(f"{path} cannot be read; submit the job anew.") from error


def say_why(run: Path, sentence: str) -> None:
    (run / _WHY).write_text(sentence)


def why_ended(run: Path, code: int) -> str:
    """In words, for an exit code that is not 0."""
    if code < 0:
        return f"its process was killed ({signal.Signals(-code).name})"
    path = run / _WHY
    said = path.read_text() if path.is_file() else ""
    return said or f"its process ended with exit status {code}; its log says more"
