"""One job: what is trained and evaluated, and how far that has come. Pure: `now_ns` is an argument.

queued ─► running ─► done
   ▲         ├─────► failed      what was given cannot be trained, or it was tried three times
   └─────────┤                   tried again: the process was killed, no sim was there, the cluster's head was lost
             └─────► cancelled   asked for; also while queued
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum, StrEnum

from pydantic import BaseModel, ConfigDict, Field

from mart.protocol.errors import Conflict
from mart.trainer.evaluate.config import EvaluationSpec
from mart.trainer.train.spec import TrainingSpec

MAX_ATTEMPTS = 3


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
    """One job of the queue. run: its folder, below the trainer's data folder. Stamps are Unix time; 0: not yet."""

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
        if code == ExitCode.LOST:
            return replace(self, state=JobState.QUEUED, attempt=self.attempt - 1, detail=why)
        if code == ExitCode.REFUSED or self.attempt >= MAX_ATTEMPTS:
            return replace(self, state=JobState.FAILED, ended_ns=now_ns, detail=why)
        return replace(self, state=JobState.QUEUED, detail=f"tried again, because {why}")

    def cancelled(self, now_ns: int) -> Job:
        """Return the cancelled job. Raises Conflict where it is over."""
        if self.is_over:
            raise Conflict(f"{self.id} is {self.state} already; there is nothing to cancel.")
        return replace(self, state=JobState.CANCELLED, ended_ns=now_ns, detail="")

    def retried(self) -> Job:
        """Return the job as it is queued anew. Raises Conflict unless it failed or was cancelled."""
        if self.state not in (JobState.FAILED, JobState.CANCELLED):
            raise Conflict(f"{self.id} is {self.state}; only a failed or cancelled job can be tried again.")
        return replace(self, state=JobState.QUEUED, attempt=0, ended_ns=0, detail="")
