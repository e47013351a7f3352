"""Table I in words: ours beside the paper's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mart.protocol.tasks import Task
from mart.trainer.evaluate.statistics import Rate
from mart.trainer.report import paper
from mart.trainer.report.coordination import Attempt, coordination

_KINDS = ("uncoordinated", "coordinated")


def row(task: Task, attempts: Sequence[Attempt]) -> dict[str, Any]:
    """Return one task as plain data, rates in per cent."""
    found = coordination(task, attempts)
    kinds = {kind: found.degradation(coordinated=kind == "coordinated") for kind in _KINDS}
    return {
        "task": task.name,
        "title": task.title,
        "episodes": found.episodes,
        "success": _percent(Rate(found.successes, found.episodes)),
        "degradation": {kind: _percent(rate) for kind, rate in kinds.items()},
        "paper": dict(zip(_KINDS, paper.DEGRADATION[task.name], strict=True))
        if task.name in paper.DEGRADATION
        else None,
        "stages": [
            {
                "subtasks": list(stage.subtasks),
                "coordinated": stage.coordinated,
                "entered": stage.entered,
                "passed": stage.passed,
            }
            for stage in found.stages
        ],
    }


def text(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return Table I in lines, ours beside the paper's."""
    lines = ["Marginal success-rate degradation, % of all episodes (95 % interval)"]
    for row in rows:
        lines += ["", f"{row['title']}: {row['episodes']} episodes, {_words(row['success'])} succeeded"]
        for kind in _KINDS:
            beside = f"   paper {row['paper'][kind]:.1f}" if row["paper"] else ""
            lines.append(f"  {kind:<14} {_words(row['degradation'][kind]):<20}{beside}")
        for stage in row["stages"]:
            kind = "coordinated" if stage["coordinated"] else "uncoordinated"
            names = ", ".join(stage["subtasks"])
            lines.append(f"    {stage['passed']} of {stage['entered']} passed {names} ({kind})")
    return "\n".join(lines)


def _percent(rate: Rate | None) -> dict[str, float] | None:
    if rate is None:
        return None
    low, high = rate.interval
    return {"value": 100 * rate.value, "low": 100 * low, "high": 100 * high}


def _words(rate: Mapping[str, float] | None) -> str:
    return "–" if rate is None else f"{rate['value']:.1f} ({rate['low']:.0f}–{rate['high']:.0f})"
