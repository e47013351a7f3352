"""What is written down of each step of a reproduction: who runs the steps writes it, reports read it.

FOLDER/plan.json            what was asked for last, and every step of it
FOLDER/steps/NAME.json      one step: command, inputs and results by their hashes, attempts, versions
FOLDER/logs/NAME.log        what its command said
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Literal, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from mart.protocol.errors import Corrupt, NotFound
from mart.runtime.atomic_file import PUBLIC, write_atomically

PLAN_FILE, STEPS, LOGS = "plan.json", "steps", "logs"

M = TypeVar("M", bound=BaseModel)
StepKind = Literal["collect", "train", "eval", "table"]


class StepAttempt(BaseModel):
    """One try at a step. ended_ns, exit_code: None while it runs. wall_s: until its end, or its last sign of life."""

    model_config = ConfigDict(frozen=True)

    began_ns: int
    ended_ns: int | None = None
    exit_code: int | None = None

    @property
    def wall_s(self) -> float:
        """Seconds from beginning to end; 0 where the end is not known."""
        return 0.0 if self.ended_ns is None else (self.ended_ns - self.began_ns) / 1e9


class PlannedStep(BaseModel):
    """A step as a plan says it. command: of `mart`, run in the reproduction's folder. inputs, results: paths there.

    table, task, model: the cell it is for; empty where it serves several. seeds: of what it trains, collects or judges.
    """

    model_config = ConfigDict(frozen=True)

    name: str
    kind: StepKind
    command: tuple[str, ...]
    inputs: tuple[str, ...] = ()
    result: str
    after: tuple[str, ...] = ()
    table: str = ""
    task: str = ""
    model: str = ""
    seeds: tuple[int, ...] = ()
    stdout: bool = False  # the result is what the command prints


class StepRecord(BaseModel):
    """What became of a step. status: `running` also where it was killed. note: what a reader has to know of it."""

    model_config = ConfigDict(frozen=True)

    step: PlannedStep
    status: Literal["running", "done", "failed", "interrupted"]
    inputs: Mapping[str, str]  # path → SHA-256
    result: str = ""  # SHA-256
    attempts: tuple[StepAttempt, ...] = ()
    versions: Mapping[str, str] = {}
    why: str = ""
    note: str = ""

    @property
    def wall_s(self) -> float:
        """Seconds of all attempts whose end is known."""
        return sum(attempt.wall_s for attempt in self.attempts)


class Plan(BaseModel):
    """What was asked for, as words of the command line and as options, and the steps that it takes."""

    model_config = ConfigDict(frozen=True)

    asked: tuple[str, ...]
    preset: str
    tables: tuple[str, ...]
    steps: tuple[PlannedStep, ...]


def write_record(folder: Path, record: StepRecord) -> None:
    """Write the record of a step, on the disk when this returns."""
    path = folder / STEPS / f"{record.step.name}.json"
    write_atomically(path, (record.model_dump_json(indent=2) + "\n").encode(), PUBLIC)


def read_records(folder: Path) -> dict[str, StepRecord]:
    """Return every record of a folder by its step's name. Raises Corrupt where one is none."""
    return {
        record.step.name: record
        for path in sorted((folder / STEPS).rglob("*.json"))
        for record in [_read(path, StepRecord)]
    }


def write_plan(folder: Path, plan: Plan) -> None:
    """Write down what is to be done."""
    write_atomically(folder / PLAN_FILE, (plan.model_dump_json(indent=2) + "\n").encode(), PUBLIC)


def read_plan(folder: Path) -> Plan:
    """Return what was asked for in a folder. Raises NotFound where nothing was, Corrupt where it cannot be read."""
    path = folder / PLAN_FILE
    if not path.is_file():
        raise NotFound(f"There is no reproduction in {folder}; `mart reproduce … --out {folder}` begins one.")
    return _read(path, Plan)


def _read(path: Path, kind: type[M]) -> M:
    try:
        return kind.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise Corrupt(
            f"{path} cannot be read ({error.error_count()} faults); move it away, and what it says is done again."
        ) from error
