"""Read a reproduction (`mart reproduce`), however far it has come: what it found, what is missing, how it was made."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mart.protocol.errors import NotFound
from mart.runtime.step_record import Plan, PlannedStep, StepRecord, read_plan, read_records
from mart.trainer.evaluate.evaluation import Evaluation, read_evaluations
from mart.trainer.report import paper
from mart.trainer.report.claims import ComparedClaim, compare_claims
from mart.trainer.report.results import Results, read_results
from mart.trainer.train.metrics import read_held_out

TITLES = {
    "table1": "Table I: what coordination costs operators",
    "table2": "Table II: experienced operators",
    "table3": "Table III: user study",
}
REPORTED: Mapping[str, paper.Results] = {"table2": paper.EXPERIENCED, "table3": paper.USER_STUDY}


_DOING = {"collect": "collecting", "train": "training", "eval": "judging", "table": "counting"}
_ENDED = {"failed": "failed", "running": "is under way, or was killed", "interrupted": "was interrupted"}


@dataclass(frozen=True)
class MissingCell:
    """A cell that was asked for and is not there, or not whole, and why."""

    table: str
    task: str
    model: str
    why: str


@dataclass(frozen=True)
class HeldOutCurve:
    """Losses on episodes that were not learned from. points: (updates, loss), of the parts together."""

    task: str
    model: str
    points: Sequence[tuple[int, float]]


@dataclass(frozen=True)
class ReproducedTable:
    """One table of models. results: None where no cell was judged yet."""

    name: str
    results: Results | None
    claims: Sequence[ComparedClaim]
    curves: Sequence[HeldOutCurve]

    @property
    def title(self) -> str:
        """The table's name and what it is of."""
        return TITLES[self.name]


@dataclass(frozen=True)
class Reproduction:
    """All that is known of one. coordination: rows of Table I, each with the data it is from."""

    folder: Path
    plan: Plan
    records: Mapping[str, StepRecord]
    tables: Sequence[ReproducedTable]
    coordination: Sequence[Mapping[str, Any]]
    missing: Sequence[MissingCell]

    @property
    def wall_s(self) -> float:
        """Seconds of all steps together, one after the other."""
        return sum(record.wall_s for record in self.records.values())

    @property
    def done(self) -> int:
        """How many steps of the plan are done."""
        found = [self.records.get(step.name) for step in self.plan.steps]
        return sum(record is not None and record.status == "done" for record in found)


def read_reproduction(folder: Path) -> Reproduction:
    """Read what is in the folder of a reproduction. Raises NotFound where there is none, Corrupt for damage."""
    plan, records = read_plan(folder), read_records(folder)
    steps = {step.name: step for step in (*(r.step for r in records.values()), *plan.steps)}
    tables = [_table(folder, name) for name in REPORTED if any(step.table == name for step in steps.values())]
    return Reproduction(
        folder,
        plan,
        records,
        tables,
        list(_coordination(folder, records)),
        [cell for step in steps.values() for cell in _missing(step, steps, records, tables)],
    )


def _table(folder: Path, name: str) -> ReproducedTable:
    runs = folder / "runs" / name
    try:
        results = read_results(runs, TITLES[name], REPORTED[name])
    except NotFound:
        results = None
    evaluations: dict[tuple[str, str], list[Evaluation]] = {}
    for path in sorted(runs.rglob("evaluations.jsonl")):
        for found in read_evaluations(path):
            evaluations.setdefault((found.task, found.model), []).append(found)
    tasks = results.tasks if results else []
    curves = [
        HeldOutCurve(path.parent.parent.name, path.parent.name, points)
        for path in sorted(runs.rglob("metrics.jsonl"))
        if (points := read_held_out(path))
    ]
    return ReproducedTable(name, results, compare_claims(tasks, evaluations, REPORTED[name]), curves)


def _coordination(folder: Path, records: Mapping[str, StepRecord]) -> Sequence[Mapping[str, Any]]:
    return [
        {**row, "from": "user study" if name.endswith("-study") else "experienced operators"}
        for name, record in records.items()
        if record.step.table == "table1"
        and record.status == "done"
        and (folder / record.step.result).is_file()
        for row in json.loads((folder / record.step.result).read_bytes())["tasks"]
    ]


def _missing(
    step: PlannedStep,
    steps: Mapping[str, PlannedStep],
    records: Mapping[str, StepRecord],
    tables: Sequence[ReproducedTable],
) -> list[MissingCell]:
    """Return the cell of a judging step, or of a row of Table I, where it is not whole."""
    if step.kind not in ("eval", "table"):
        return []
    record = records.get(step.name)
    if record is None or record.status != "done":
        return [MissingCell(step.table, step.task, step.model, _why(step, steps, records))]
    wanted = [seed for name in step.after for seed in steps[name].seeds] if step.kind == "eval" else []
    found = next((table.results for table in tables if table.name == step.table), None)
    cell = found.cells.get(step.task, {}).get(step.model) if found else None
    if step.kind == "eval" and (cell is None or len(cell.rates.seeds) < len(wanted)):
        there = 0 if cell is None else len(cell.rates.seeds)
        return [MissingCell(step.table, step.task, step.model, f"{there} of {len(wanted)} seeds are there")]
    return []


def _why(step: PlannedStep, steps: Mapping[str, PlannedStep], records: Mapping[str, StepRecord]) -> str:
    """Say what keeps a step from being done: itself, or the first of what it needs."""
    record = records.get(step.name)
    if record is not None and record.status != "done":
        why = f": {record.why}" if record.why else ""
        return f"{_DOING[step.kind]} {_ENDED[record.status]}{why} (logs/{step.name}.log)"
    for name in step.after:
        needed = records.get(name)
        if needed is None or needed.status != "done":
            return _why(steps[name], steps, records) if name in steps else f"{name} has not begun"
    return f"{_DOING[step.kind]} has not begun"
