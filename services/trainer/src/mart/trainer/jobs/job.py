"""One job: what is trained and evaluated, and how far that has come. Pure: `now_ns` is an argument.

queued ─► running ─► done
   ▲         ├─────► failed      what was given cannot be trained, or it was tried three times
   └─────────┤                   tried again: the process was killed, no sim was there, the cluster's head was lost
             └─────► cancelled   asked for; also while queued

A setback (no sim, a lost cluster or trainer) costs no attempt: the job waits, the longer the more setbacks came without
ten minutes of work between them, and fails after twenty.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum, StrEnum

from pydantic import BaseModel, ConfigDict, Field

from mart.protocol.errors import Conflict
from mart.trainer.evaluate.config import EvaluationSpec
from mart.trainer.train.spec import TrainingSpec

MAX_ATTEMPTS = 3
MAX_SETBACKS = 20  # by then, over two hours have gone by
_SECOND_NS = 1_000_000_000
_FIRST_WAIT_S, _LONGEST_WAIT_S = 10, 600
_LONG_RUN_S = 600


class JobState(StrEnum):
    """Name how far a job has come, as in the job table and, with the prefix JOB_STATE_, on the wire."""

    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


class ExitCode(IntEnum):
    """Tell how the process of a job ended. Any other exit code is a crash."""

    DONE = 0
    REFUSED = 1  # what was given is wrong: trying again would not help
    STOPPED = 3  # asked to
    AWAY = 75  # something that it needs cannot be reached now (EX_TEMPFAIL of sysexits.h)
    LOST = 76  # whoever ran it is gone, and it did nothing wrong


class JobSpec(BaseModel):
    """What one job trains, and how its checkpoints are evaluated; `request` and `judging` in files."""

    model_config = ConfigDict(frozen=True, validate_by_name=True, serialize_by_alias=True)

    training: TrainingSpec = Field(alias="request")
    evaluation: EvaluationSpec = Field(alias="judging")


@dataclass(frozen=True)
class Job:
    """One job of the queue. run: its folder, below the trainer's data folder. Stamps are Unix time; 0: not yet.

    setbacks: how often it could not be gone on with, in a row. retry_ns: it is not started before.
    """

    number: int
    sweep: int
    spec: JobSpec
    executor: str
    run: str
    state: JobState = JobState.QUEUED
    attempt: int = 0
    detail: str = ""
    submitted_ns: int = 0
    started_ns: int = 0
    ended_ns: int = 0
    setbacks: int = 0
    retry_ns: int = 0

    @property
    def id(self) -> str:
        """The job's name for people and on the wire, such as `job-0007`."""
        return f"job-{self.number:04}"

    @property
    def is_over(self) -> bool:
        """Whether the job was done, failed or was cancelled."""
        return self.state in (JobState.DONE, JobState.FAILED, JobState.CANCELLED)

    def started(self, now_ns: int) -> Job:
        """Return the job as it is when its next attempt begins."""
        return replace(
            self, state=JobState.RUNNING, attempt=self.attempt + 1, started_ns=now_ns, ended_ns=0, detail=""
        )

    def ended(self, code: int, why: str, now_ns: int) -> Job:
        """Return the job as it is when its process has ended with `code`; one that is not running stays as it is.

        why: in words, where it was not done.
        """
        if self.state is not JobState.RUNNING:
            return self
        if code == ExitCode.DONE:
            return replace(self, state=JobState.DONE, ended_ns=now_ns, detail="")
        if code in (ExitCode.LOST, ExitCode.AWAY):
            return self._set_back(code, why, now_ns)
        if code == ExitCode.REFUSED or self.attempt >= MAX_ATTEMPTS:
            return replace(self, state=JobState.FAILED, ended_ns=now_ns, detail=why)
        return replace(self, state=JobState.QUEUED, detail=f"tried again, because {why}")

    def _set_back(self, code: int, why: str, now_ns: int) -> Job:
        """Queue it again after a while. Whoever was only lost waits for nothing the first time."""
        has_worked = now_ns - self.started_ns >= _LONG_RUN_S * _SECOND_NS
        setbacks = 1 if has_worked else self.setbacks + 1
        if setbacks > MAX_SETBACKS:
            detail = f"{why}; it was tried {MAX_SETBACKS} times: retry it when that is mended"
            return replace(self, state=JobState.FAILED, ended_ns=now_ns, detail=detail)
        doublings = setbacks - (2 if code == ExitCode.LOST else 1)
        wait_s = 0 if doublings < 0 else min(_FIRST_WAIT_S * 2**doublings, _LONGEST_WAIT_S)
        return replace(
            self,
            state=JobState.QUEUED,
            attempt=self.attempt - 1,
            setbacks=setbacks,
            retry_ns=now_ns + wait_s * _SECOND_NS,
            detail=f"tried again in {wait_s} s, because {why}" if wait_s else why,
        )

    def cancelled(self, now_ns: int) -> Job:
        """Return the cancelled job. Raises Conflict where it is over."""
        if self.is_over:
            raise Conflict(f"{self.id} is {self.state} already; there is nothing to cancel.")
        return replace(self, state=JobState.CANCELLED, ended_ns=now_ns, detail="")

    def retried(self) -> Job:
        """Return the job as it is queued anew. Raises Conflict unless it failed or was cancelled."""
        if self.state not in (JobState.FAILED, JobState.CANCELLED):
            raise Conflict(f"{self.id} is {self.state}; only a failed or cancelled job can be tried again.")
        return replace(self, state=JobState.QUEUED, attempt=0, setbacks=0, retry_ns=0, ended_ns=0, detail="")
