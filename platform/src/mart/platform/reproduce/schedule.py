"""What is to be done next, and how long it will take: records in, decisions out. Pure."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from mart.runtime.step_record import PlannedStep, StepRecord


class StepState(StrEnum):
    """Say where a step stands. changed: what it was made from, or how, is not what it would be now."""

    TODO = "to do"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CHANGED = "changed"


def state_of(
    step: PlannedStep, record: StepRecord | None, inputs: Mapping[str, str], result: str
) -> tuple[StepState, str]:
    """Return where a step stands whose inputs and result have these hashes now, and why in a clause.

    For a step all of whose inputs are made. A result that was begun counts, also where its step was killed or failed.
    """
    if record is None or not result:
        return StepState.TODO, "" if record is None or record.status != "done" else "its result is gone"
    if record.step.command != step.command:
        return StepState.CHANGED, f"its command was `mart {' '.join(record.step.command)}`"
    differing = [path for path, sha256 in inputs.items() if record.inputs.get(path) != sha256]
    if differing:
        return StepState.CHANGED, f"{', '.join(differing)} is not what it was made from"
    return (StepState.DONE if record.status == "done" else StepState.TODO), ""


def ready(
    steps: Sequence[PlannedStep], states: Mapping[str, StepState], running: Collection[str]
) -> list[PlannedStep]:
    """Return the steps that can begin, in the plan's order: what they need is done.

    Collecting takes every core, so nothing else begins beside it.
    """
    kinds = {step.name: step.kind for step in steps}
    if any(kinds[name] == "collect" for name in running):
        return []
    found = [
        step
        for step in steps
        if states[step.name] is StepState.TODO
        and step.name not in running
        and all(states.get(name) is StepState.DONE for name in step.after)
    ]
    return [step for step in found if step.kind != "collect" or not running]


@dataclass(frozen=True)
class Remaining:
    """How long what is left will take, as far as finished steps tell. unknown: steps of kinds that never ran here."""

    steps: int
    wall_s: float
    unknown: int

    def in_words(self) -> str:
        """Return "6 left: about 40 min", and what that leaves out."""
        if not self.steps:
            return "nothing left"
        if self.steps == self.unknown:
            return f"{self.steps} left, for how long is not known yet"
        more = f" and {self.unknown} of a kind that has not run yet" if self.unknown else ""
        return f"{self.steps} left: about {duration(self.wall_s)}{more}"


def remaining(
    steps: Sequence[PlannedStep],
    states: Mapping[str, StepState],
    records: Mapping[str, StepRecord],
    jobs: int,
) -> Remaining:
    """Estimate by the mean of finished steps of the same kind, task and model, else of kind and task, else of kind."""
    left = [step for step in steps if states[step.name] in (StepState.TODO, StepState.RUNNING)]
    done = [record for record in records.values() if record.status == "done"]
    expected = [_expected_s(step, done) for step in left]
    known = [wall_s for wall_s in expected if wall_s is not None]
    return Remaining(len(left), sum(known) / jobs, len(left) - len(known))


def _expected_s(step: PlannedStep, done: Sequence[StepRecord]) -> float | None:
    def alike(record: StepRecord, *names: str) -> bool:
        return all(getattr(record.step, name) == getattr(step, name) for name in names)

    for names in (("kind", "task", "model"), ("kind", "task"), ("kind",)):
        walls = [record.wall_s for record in done if alike(record, *names)]
        if walls:
            return sum(walls) / len(walls)
    return None


def duration(wall_s: float) -> str:
    """Return a number of seconds as people say it: 40 s, 12 min, 3.5 h."""
    if wall_s < 90:
        return f"{wall_s:.0f} s"
    return f"{wall_s / 60:.0f} min" if wall_s < 5400 else f"{wall_s / 3600:.1f} h"
