"""The process of one job: `python -m mart.trainer.jobs.work RUN` trains and judges what `RUN/job.json` asks.

The same call on a run that was begun goes on from its newest checkpoint. The exit code is a job.End.
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
from mart.runtime.service import configure_logging, stop_requested
from mart.trainer.evaluate import words
from mart.trainer.evaluate.judge import Judge, Rules
from mart.trainer.evaluate.replicas import worlds
from mart.trainer.evaluate.result import Evaluation
from mart.trainer.jobs.job import End, Judging
from mart.trainer.jobs.order import WorkOrder, say_why
from mart.trainer.runs import RunDirectory
from mart.trainer.train import train

_log = logging.getLogger(__name__)
_LOCK = "lock"


def work(run: Path, stop: threading.Event) -> End:
    """Trains, judges each checkpoint as it comes, and scores the best. Says in the run's folder why it was not done."""
    try:
        order = WorkOrder.load(run)
        with contextlib.ExitStack() as stack:
            jury = Jury(RunDirectory(run), order.judging, stack)
            train(order.request, run, stop, lambda *_: jury.look())
            if not stop.is_set():
                jury.conclude()
    except MartError as error:
        _log.error("%s", error)
        say_why(run, str(error))
        return End.AWAY if isinstance(error, Unavailable) else End.REFUSED
    return End.STOPPED if stop.is_set() else End.DONE


class Jury:
    """Judges a run while it is trained. Worlds are asked for when the first checkpoint is there."""

    def __init__(self, run: RunDirectory, judging: Judging, stack: contextlib.ExitStack) -> None:
        self._run = run
        self._judging = judging
        self._stack = stack
        self._judge: Judge | None = None
        self._seen: tuple[int, ...] = ()
        self._away = False

    def look(self) -> None:
        """Judges what is new. Where no world can be reached, training goes on, and `conclude` tries again."""
        checkpointed = self._run.checkpointed()
        if self._away or checkpointed == self._seen or not self._judging.episodes:
            return
        self._seen = checkpointed
        try:
            self._require_judge().new(self._run, _say)
        except Unavailable as error:
            _log.warning("Judging waits for the end of the training: %s", error)
            self._away = True

    def conclude(self) -> None:
        """Whatever is left to judge, then the scores. Raises Unavailable."""
        if self._judging.episodes:
            judge = self._require_judge()
            judge.new(self._run, _say)
            judge.score(self._run, _say)

    def _require_judge(self) -> Judge:
        if self._judge is None:
            client = self._stack.enter_context(worlds(self._judging.replicas))
            rules = Rules(self._judging.episodes, self._judging.score_episodes)
            self._judge = Judge(client, rules)
        return self._judge


def _say(evaluation: Evaluation) -> None:
    _log.info("%s", words.line(evaluation))


@contextlib.contextmanager
def _alone(run: Path) -> Iterator[None]:
    """Waits while an earlier attempt at this run still lives, on whichever machine."""
    with (run / _LOCK).open("ab") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def main() -> int:
    run = Path(sys.argv[1])
    configure_logging("INFO", "job")
    with stop_requested() as stop, _alone(run):
        return work(run, stop)


if __name__ == "__main__":
    sys.exit(main())
