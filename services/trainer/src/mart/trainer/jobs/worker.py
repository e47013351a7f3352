"""The process of one job: `python -m mart.trainer.jobs.worker RUN` trains and evaluates what `RUN/job.json` asks.

The same call on a run that was begun goes on from its newest checkpoint. The exit code is an ExitCode.
"""

from __future__ import annotations

import contextlib
import fcntl
import logging
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

from mart.protocol.errors import MartError, Unavailable
from mart.runtime.log_format import configure_logging
from mart.runtime.service import stop_requested
from mart.trainer.evaluate.background_evaluator import BackgroundEvaluator
from mart.trainer.jobs.job import ExitCode
from mart.trainer.jobs.job_files import load_spec, say_why
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.training import train

_log = logging.getLogger(__name__)
_LOCK = "lock"


def run_job(run: Path, stop: threading.Event) -> ExitCode:
    """Train, evaluate each checkpoint as it comes, and score the best; return how that ended.

    Where it was not done, the run's folder says why.
    """
    try:
        spec = load_spec(run)
        with contextlib.ExitStack() as stack:
            evaluator = BackgroundEvaluator(RunDirectory(run), spec.evaluation, stack)
            train(spec.training, run, stop, lambda *_: evaluator.evaluate_new())
            if not stop.is_set():
                evaluator.finish()
    except MartError as error:
        _log.error("%s", error)
        say_why(run, str(error))
        return ExitCode.AWAY if isinstance(error, Unavailable) else ExitCode.REFUSED
    return ExitCode.STOPPED if stop.is_set() else ExitCode.DONE


@contextlib.contextmanager
def _alone(run: Path) -> Iterator[None]:
    """Waits while an earlier attempt at this run still lives, on whichever machine."""
    with (run / _LOCK).open("ab") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def main() -> int:
    """Run the job whose folder is the first argument, and return its exit code."""
    run = Path(sys.argv[1])
    configure_logging("INFO", "job")
    with stop_requested() as stop, _alone(run):
        return run_job(run, stop)


if __name__ == "__main__":
    sys.exit(main())
