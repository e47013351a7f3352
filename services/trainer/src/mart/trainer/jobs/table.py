"""The job table: SQLite in write-ahead mode, so that what was accepted is there after a power cut."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mart.protocol.errors import Corrupt, NotFound
from mart.trainer.evaluate.config import EvaluationSpec
from mart.trainer.jobs.job import Job, JobSpec, JobState
from mart.trainer.train.spec import TrainingSpec

_VERSION = 2
_SCHEMA = """
CREATE TABLE jobs (
    number INTEGER PRIMARY KEY,
    sweep INTEGER NOT NULL,
    request TEXT NOT NULL,
    judging TEXT NOT NULL,
    executor TEXT NOT NULL,
    run TEXT NOT NULL,
    state TEXT NOT NULL,
    attempt INTEGER NOT NULL,
    detail TEXT NOT NULL,
    submitted_ns INTEGER NOT NULL,
    started_ns INTEGER NOT NULL,
    ended_ns INTEGER NOT NULL,
    setbacks INTEGER NOT NULL DEFAULT 0,
    retry_ns INTEGER NOT NULL DEFAULT 0
) STRICT;
CREATE INDEX by_state ON jobs (state);
"""
_FROM_VERSION_1 = """
ALTER TABLE jobs ADD COLUMN setbacks INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN retry_ns INTEGER NOT NULL DEFAULT 0;
"""
_COLUMNS = (
    "number", "sweep", "request", "judging", "executor", "run", "state", "attempt", "detail", "submitted_ns",
    "started_ns", "ended_ns", "setbacks", "retry_ns",
)  # fmt: skip
_NAMES, _PLACES = ", ".join(_COLUMNS), ", ".join("?" * len(_COLUMNS))
_PUT = f"INSERT OR REPLACE INTO jobs ({_NAMES}) VALUES ({_PLACES})"  # noqa: S608 - our own names


@dataclass(frozen=True)
class QueuedJob:
    """Hold what decides whether a job is started: its spec, which may name thousands of files, is not read for that."""

    number: int
    executor: str
    detail: str
    retry_ns: int


class JobTable:
    """Keep jobs in a SQLite file. For one thread. Raises Corrupt where the file is no job table of this version."""

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._connection = sqlite3.connect(path)
        try:
            self._open(path)
        except Corrupt:
            self._connection.close()
            raise

    def close(self) -> None:
        """Let go of the file."""
        self._connection.close()

    def put(self, jobs: Sequence[Job]) -> None:
        """Write the jobs, all of them or none; they are on the disk when this returns."""
        with self._connection:
            self._connection.executemany(_PUT, [_row(job) for job in jobs])

    def get(self, number: int) -> Job:
        """Return the job with this number. Raises NotFound."""
        found = self._select("WHERE number = ?", number)
        if not found:
            raise NotFound(f"There is no job {f'job-{number:04}'!r}; `mart jobs list` tells which there are.")
        return found[0]

    def newest(self, limit: int, sweep: int | None = None) -> list[Job]:
        """Return up to `limit` jobs, the newest first; only those of one sweep where it is named."""
        if sweep is None:
            return self._select("ORDER BY number DESC LIMIT ?", limit)
        return self._select("WHERE sweep = ? ORDER BY number DESC LIMIT ?", sweep, limit)

    def in_state(self, state: JobState) -> list[Job]:
        """Return the jobs in this state, the oldest first."""
        return self._select("WHERE state = ? ORDER BY number", state)

    def queued(self) -> list[QueuedJob]:
        """Return what waits, the oldest first."""
        rows = self._connection.execute(
            "SELECT number, executor, detail, retry_ns FROM jobs WHERE state = ? ORDER BY number",
            (JobState.QUEUED,),
        )
        return [QueuedJob(*row) for row in rows]

    def counts(self) -> dict[JobState, int]:
        """Return how many jobs are in each state, 0 for those that none is in."""
        rows = self._connection.execute("SELECT state, count(*) FROM jobs GROUP BY state")
        return dict.fromkeys(JobState, 0) | {JobState(state): count for state, count in rows}

    def set_detail(self, number: int, detail: str) -> None:
        """Say something of a job, and leave all else of it as it is."""
        with self._connection:
            self._connection.execute("UPDATE jobs SET detail = ? WHERE number = ?", (detail, number))

    def last(self) -> tuple[int, int]:
        """Return the highest numbers of a job and of a sweep so far; 0 before the first."""
        job, sweep = self._connection.execute("SELECT max(number), max(sweep) FROM jobs").fetchone()
        return job or 0, sweep or 0

    def _open(self, path: Path) -> None:
        """Make the tables where the file is new. Raises Corrupt where it is another's."""
        try:
            self._connection.execute("PRAGMA journal_mode = WAL")
            self._connection.execute("PRAGMA synchronous = FULL")
            (version,) = self._connection.execute("PRAGMA user_version").fetchone()
            if version == 0:
                self._become(_SCHEMA)
            elif version == 1:
                self._become(_FROM_VERSION_1)
            (version,) = self._connection.execute("PRAGMA user_version").fetchone()
        except sqlite3.DatabaseError as error:
            raise Corrupt(f"{path} is no job table: {error}; move it away to begin a new one.") from error
        if version != _VERSION:
            raise Corrupt(f"{path} is of version {version}; this trainer reads {_VERSION}: move it away.")

    def _become(self, script: str) -> None:
        """Make this version's tables by a script, wholly or not at all."""
        self._connection.executescript(f"BEGIN; {script} PRAGMA user_version = {_VERSION}; COMMIT;")

    def _select(self, clause: str, *values: int | str) -> list[Job]:
        rows = self._connection.execute(f"SELECT {_NAMES} FROM jobs {clause}", values)  # noqa: S608
        return [_job(dict(zip(_COLUMNS, row, strict=True))) for row in rows]


def _row(job: Job) -> tuple[int | str, ...]:
    text = {
        "request": job.spec.training.model_dump_json(),
        "judging": job.spec.evaluation.model_dump_json(),
        "state": str(job.state),
    }
    return tuple(text[name] if name in text else getattr(job, name) for name in _COLUMNS)


def _job(values: dict[str, Any]) -> Job:
    spec = JobSpec(
        training=TrainingSpec.model_validate_json(values.pop("request")),
        evaluation=EvaluationSpec.model_validate_json(values.pop("judging")),
    )
    return Job(spec=spec, **values | {"state": JobState(values["state"])})
