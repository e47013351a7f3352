"""What a job's process is told, and how it says how it ended: files in the run's folder."""

from __future__ import annotations

import contextlib
import signal
from pathlib import Path

from pydantic import ValidationError

from mart.protocol.errors import Corrupt
from mart.trainer.jobs.job import JobSpec

LOG = "log.txt"
_SPEC = "job.json"
_WHY = "why.txt"


def save_spec(run: Path, spec: JobSpec) -> None:
    """Write the job's spec into the run's folder, which is made; why an earlier attempt ended is forgotten."""
    run.mkdir(parents=True, exist_ok=True)
    (run / _SPEC).write_text(spec.model_dump_json())
    (run / _WHY).unlink(missing_ok=True)


def load_spec(run: Path) -> JobSpec:
    """Read what `save_spec` wrote. Raises Corrupt where it is missing or damaged."""
    path = run / _SPEC
    try:
        return JobSpec.model_validate_json(path.read_bytes())
    except (OSError, ValidationError) as error:
        raise Corrupt(f"{path} cannot be read; submit the job anew.") from error


def say_why(run: Path, sentence: str) -> None:
    """Leave a sentence in the run's folder that says why the job was not done."""
    (run / _WHY).write_text(sentence)


def why_ended(run: Path, code: int) -> str:
    """Return in words why a job's process ended with this exit code, which is not 0. Raises nothing."""
    if code < 0:
        known = -code in set(signal.Signals)
        return f"its process was killed ({signal.Signals(-code).name if known else f'signal {-code}'})"
    said = ""
    with contextlib.suppress(OSError):  # it left no word, or one that cannot be read
        said = (run / _WHY).read_text(errors="replace")
    return said or f"its process ended with exit status {code}; its log says more"
