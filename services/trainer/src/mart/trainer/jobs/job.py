"""One job: what is trained and judged, and how far that has come. Pure: `now_ns` is an argument.

queued ─► running ─► done
   ▲         ├─────► failed      what was given cannot be trained, or it was tried three times
   └─────────┤                   tried again: the process was killed, no sim was there, the cluster's head was lost
             └─────► cancelled   asked for; also while queued
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum, StrEnum

from pydantic import BaseModel, ConfigDict

from mart.protocol.errors import Conflict
from mart.trainer.request import TrainRequest

MAX_ATTEMPTS = 3


class State(StrEnum):
    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


class End(IntEnum):
    """How the process of a job ended: its exit code. Any other is a crash."""

    DONE = 0
    REFUSED = 1  # what was given is wrong: trying again would not help
    STOPPED = 3  # asked to
    AWAY = 75  # something that it needs cannot be reached now (EX_TEMPFAIL of sysexits.h)
    LOST = 76  # whoever ran it is gone, and it did nothing wrong


class Judging(BaseModel):
    """How checkpoints are judged; as evaluate.judge.Rules. replicas: running ones; none: one is started."""

    model_config = ConfigDict(frozen=True)

    task: str
    episodes: int = 30
    score_episodes: int = 100
    replicas: tuple[str, ...] = ()


@dataclass(frozen=True)
class Job:
    """run: its folder, below the trainer's data folder. Stamps are Unix time; 0: not yet."""

    number: int
    sweep: int
    request: TrainRequest
    judging: Judging
    executor: str
    run: str
    state: State = State.QUEUED
    attempt: int = 0
    detail: str = ""
    submitted_ns: int = 0
    started_ns: int = 0
    ended_ns: int = 0

    @property
    def id(self) -> str:
        return f"job-{self.number:04}"

    @property
    def is_over(self) -> bool:
        return self.state in (State.DONE, State.FAILED, State.CANCELLED)

    def started(self, now_ns: int) -> Job:
        return replace(
            self, state=State.RUNNING, attempt=self.attempt + 1, started_ns=now_ns, ended_ns=0, detail=""
        )

    def ended(self, code: int, why: str, now_ns: int) -> Job:
        """`why`: in words, where it was not done. A job that is not running stays as it is."""
        if self.state is not State.RUNNING:
            return self
        if code == End.DONE:
            return replace(self, state=State.DONE, ended_ns=now_ns, detail="")
        if code == End.LOST:
            return replace(self, state=State.QUEUED, attempt=self.attempt - 1, detail=why)
        if code == End.REFUSED or self.attempt >= MAX_ATTEMPTS:
            return replace(self, state=State.FAILED, ended_ns=now_ns, detail=why)
        return replace(self, state=State.QUEUED, detail=f"tried again, because {why}")

    def cancelled(self, now_ns: int) -> Job:
        """Raises Conflict where it is over."""
        if self.is_over:
            raise Conflict(f"{self.id} is {self.state} already; there is nothing to cancel.")
        return replace(self, state=State.CANCELLED, ended_ns=now_ns, detail="")

    def retried(self) -> Job:
        """Raises Conflict unless it failed or was cancelled."""
        if self.state not in (State.FAILED, State.CANCELLED):
            raise Conflict(f"{self.id} is {self.state}; only a failed or cancelled job can be tried again.")
        return replace(self, state=State.QUEUED, attempt=0, ended_ns=0, detail="")
