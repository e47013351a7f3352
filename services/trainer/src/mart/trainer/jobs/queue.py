"""The queue: accepts sweeps, starts jobs where there is room, and brings each to an end. For one thread."""

from __future__ import annotations

import itertools
import logging
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from mart.protocol.errors import Conflict, NotFound
from mart.trainer.jobs.executors.executor import Executor, JobEnded
from mart.trainer.jobs.job import ExitCode, Job, JobSpec, JobState
from mart.trainer.jobs.job_files import save_spec
from mart.trainer.jobs.table import JobTable

_log = logging.getLogger(__name__)

MAX_WAITING = 1000


class JobQueue:
    """Bring jobs to their ends on their executors. For one thread.

    data_dir: what the folders of runs are relative to. Stamps are Unix time.
    """

    def __init__(
        self, table: JobTable, executors: Mapping[str, Executor], data_dir: Path, now_ns: int
    ) -> None:
        self._table = table
        self._executors = executors
        self._data_dir = data_dir
        self._busy: dict[int, str] = {}  # job → executor, until its process has ended, also a cancelled one's
        for job in table.in_state(
            JobState.RUNNING
        ):  # their processes died with the trainer that started them
            self._put(job.ended(code=ExitCode.LOST, why="the trainer was stopped meanwhile", now_ns=now_ns))

    def submit(self, specs: Sequence[JobSpec], executor: str, now_ns: int) -> list[Job]:
        """Accept one sweep, a job for each spec, and return its jobs.

        Raises NotFound for an unknown executor and Conflict where too many are waiting already.
        """
        if executor not in self._executors:
            raise NotFound.named("executor", executor, self._executors)
        waiting = len(self._table.queued())
        if waiting + len(specs) > MAX_WAITING:
            raise Conflict(
                f"{len(specs)} jobs were submitted, but {waiting} of at most {MAX_WAITING} wait already; "
                "cancel some or wait."
            )
        job, sweep = self._table.last()
        numbers = itertools.count(job + 1)
        jobs = [self._job(next(numbers), sweep + 1, spec, executor, now_ns) for spec in specs]
        self._table.put(jobs)
        return jobs

    def advance(self, now_ns: int) -> None:
        """Start what can be started and need not wait any longer, the oldest first."""
        for job in self._table.queued():
            executor = self._executors.get(job.executor)
            if executor is None or job.number in self._busy or job.retry_ns > now_ns:
                continue
            if Counter(self._busy.values())[job.executor] < executor.slots:
                self._start(self._table.get(job.number), executor, now_ns)
            elif executor.trouble and not job.detail:
                self._table.set_detail(job.number, executor.trouble)

    def end(self, ended: JobEnded, now_ns: int) -> None:
        """Take note that a job's process has ended. One that was cancelled meanwhile stays cancelled."""
        self._busy.pop(ended.job, None)
        job = self._table.get(ended.job)
        after = job.ended(ended.code, ended.why, now_ns)
        _log.info("%s is %s %s", after.id, after.state, after.detail)
        self._put(after)

    def cancel(self, jobs: Iterable[Job], now_ns: int) -> list[Job]:
        """Cancel those of the jobs that are not over. Raises Conflict where all of them are."""
        given = list(jobs)
        going = [job for job in given if not job.is_over]
        if not going:
            given[0].cancelled(now_ns)
        for job in going:
            self._put(job.cancelled(now_ns))
            if job.number in self._busy:
                self._executors[job.executor].stop(job.number)
        return [self._table.get(job.number) for job in going]

    def retry(self, job: Job) -> Job:
        """Queue a job anew. Raises Conflict unless it failed or was cancelled."""
        again = job.retried()
        self._put(again)
        return again

    def _start(self, job: Job, executor: Executor, now_ns: int) -> None:
        run = self._data_dir / job.run
        save_spec(run, job.spec)
        self._put(job.started(now_ns))
        self._busy[job.number] = job.executor
        executor.start(job.number, run.resolve())
        _log.info("%s starts: %s, attempt %d", job.id, job.spec.training.model, job.attempt + 1)

    def _put(self, job: Job) -> None:
        self._table.put([job])

    def _job(self, number: int, sweep: int, spec: JobSpec, executor: str, now_ns: int) -> Job:
        run = f"runs/sweep-{sweep:04}/job-{number:04}"
        return Job(number, sweep, spec, executor, run, submitted_ns=now_ns)
