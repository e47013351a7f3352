"""A reproduction as one page, with nothing to fetch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

from mart.runtime.step_record import StepRecord
from mart.trainer.report import claim_plots, paper, plots
from mart.trainer.report.claims import ComparedClaim
from mart.trainer.report.figures import as_svg, single_panel
from mart.trainer.report.html import render_page
from mart.trainer.report.reproduction import REPORTED, TITLES, MissingCell, ReproducedTable, Reproduction
from mart.trainer.report.results import Results


def reproduction_page(found: Reproduction) -> str:
    """Return the page of a reproduction."""
    return render_page(
        "reproduction.html",
        title="The paper, reproduced",
        summary=summary(found),
        missing=[missing_in_words(cell) for cell in found.missing],
        coordination=_coordination(found),
        tables=[_table(found, table) for table in found.tables],
        steps=[step_row(record) for record in found.records.values()],
        versions=versions_of(found.records),
        asked=" ".join(("mart", *found.plan.asked)),
    )


def summary(found: Reproduction) -> str:
    """Return in a sentence how far it has come and what that took."""
    steps = len(found.plan.steps)
    return (
        f"Preset {found.plan.preset}. {found.done} of {steps} steps are done; all attempts together took "
        f"{found.wall_s / 3600:.1f} h, one after the other."
    )


def missing_in_words(cell: MissingCell) -> str:
    """Return which cell is missing and why."""
    where = ", ".join(filter(None, (cell.model, paper.TITLES.get(cell.task, cell.task))))
    return f"{TITLES[cell.table].partition(':')[0]}: {where} – {cell.why}"


def versions_of(records: Mapping[str, StepRecord]) -> list[str]:
    """Return every set of versions that steps were made with, the most used first."""
    told = [
        ", ".join(f"{name} {own}" for name, own in record.versions.items()) for record in records.values()
    ]
    return sorted(set(told), key=told.count, reverse=True)


def step_row(record: StepRecord) -> dict[str, str]:
    """Return a step as the appendix says it."""
    return {
        "name": record.step.name,
        "status": record.status + (f" ({record.note})" if record.note else ""),
        "wall": f"{record.wall_s:.0f} s"
        + (f" in {len(record.attempts)} attempts" if len(record.attempts) > 1 else ""),
        "seeds": _span(record.step.seeds),
        "command": f"mart {' '.join(record.step.command)}",
        "inputs": "; ".join(f"{path} {sha256[:12]}" for path, sha256 in record.inputs.items()) or "–",
        "result": record.result[:12] or "–",
    }


def table_cell(results: Results | None, table: str, model: str, task: str) -> dict[str, Any]:
    """Return a cell in words: ours by both protocols, what choosing may add, and the paper's."""
    reported = REPORTED[table].get(model, {}).get(task)
    shown: dict[str, Any] = {
        "ours": None, "fresh": "", "bias": "", "best": False, "seeds": 0,
        "paper": "" if reported is None else f"{reported.mean:.1f} ± {reported.deviation:.1f}",
    }  # fmt: skip
    cell = results.cells.get(task, {}).get(model) if results else None
    if cell is None or results is None:
        return shown
    judged, interval = cell.rates, cell.fresh_interval
    shown |= {
        "ours": f"{100 * judged.paper.mean:.1f} ± {100 * judged.paper.deviation:.1f}",
        "seeds": len(judged.seeds),
    }
    if judged.pooled is not None and interval is not None and cell.selection_bias is not None:
        shown |= {
            "fresh": f"{100 * judged.pooled.value:.1f} ({100 * interval[0]:.0f}–{100 * interval[1]:.0f})",
            "bias": f"+{100 * cell.selection_bias:.0f}",
            "best": judged.pooled.value
            == max(c.rates.pooled.value for c in results.cells[task].values() if c.rates.pooled),
        }
    return shown


def rows_and_columns(table: ReproducedTable) -> tuple[list[str], list[str]]:
    """Return the models and tasks of a table: the paper's in its order, then what else there is."""
    reported = REPORTED[table.name]
    found = table.results.cells if table.results else {}
    tasks = [task for task in paper.TITLES if any(task in row for row in reported.values())]
    tasks += [task for task in found if task not in tasks]
    models = [*reported]
    models += sorted({model for of_task in found.values() for model in of_task} - set(models))
    return models, tasks


def p_in_words(p_value: float) -> str:
    """Return a p-value as it is printed: two digits, and no zeros of which nothing is known."""
    return "< 0.001" if p_value < 0.001 else f"{p_value:.3f}" if p_value < 0.1 else f"{p_value:.2f}"


def claim_row(one: ComparedClaim) -> list[str]:
    """Return a tested claim as a row: pair, task, difference, p-values, pairs, the paper's difference."""
    found, (low, high) = one.comparison, one.comparison.interval
    return [
        f"{found.first} over {found.second}",
        paper.TITLES.get(one.task, one.task),
        f"{_signed(found.difference.value, 1)} ({_signed(low)} to {_signed(high)})",
        p_in_words(found.p_value),
        p_in_words(found.mcnemar_p),
        f"{found.only_first} : {found.only_second}",
        f"{found.seeds} × {found.worlds}",
        "–" if one.reported is None else _signed(one.reported, 1),
    ]


CLAIM_COLUMNS = (
    "pair", "task", "difference, points", "p over seeds and worlds", "p of these policies (McNemar)",
    "won by one alone", "seeds × worlds", "paper",
)  # fmt: skip


def _table(found: Reproduction, table: ReproducedTable) -> dict[str, Any]:
    models, tasks = rows_and_columns(table)
    missing = {(cell.task, cell.model) for cell in found.missing if cell.table == table.name}
    return {
        "title": table.title,
        "tasks": [paper.TITLES.get(task, task) for task in tasks],
        "rows": [
            {
                "model": model,
                "cells": [
                    {
                        **table_cell(table.results, table.name, model, task),
                        "missing": (task, model) in missing,
                    }
                    for task in tasks
                ],
            }
            for model in models
        ],
        "figures": [_task(table, task) for task in (table.results.tasks if table.results else [])],
        "claims": [
            _claim(list(tested)) for _, tested in groupby(table.claims, key=lambda one: one.claim.name)
        ],
        "selection": _selection(table.results) if table.results else "",
        "columns": CLAIM_COLUMNS,
    }


def _task(table: ReproducedTable, task: str) -> dict[str, str]:
    assert table.results is not None
    curves = [curve for curve in table.curves if curve.task == task]
    return {
        "title": paper.TITLES.get(task, task),
        "success": plots.success(table.results, task),
        "learning": plots.learning(table.results, task),
        "held_out": _held_out(curves, task) if curves else "",
    }


def _held_out(curves: Sequence[Any], task: str) -> str:
    with single_panel(5.4, 3.2) as (figure, axes):
        claim_plots.draw_held_out(axes, curves)
        return as_svg(figure, f"Held-out loss over training on {task}")


def _claim(tested: Sequence[ComparedClaim]) -> dict[str, Any]:
    with single_panel(7.2, 0.9 + 0.5 * len(tested)) as (figure, axes):
        claim_plots.draw_claim(axes, tested)
        return {
            "sentence": tested[0].claim.sentence,
            "figure": as_svg(figure, tested[0].claim.sentence),
            "rows": [claim_row(one) for one in tested],
        }


def _selection(results: Results) -> str:
    with single_panel(5.4, 3.6) as (figure, axes):
        claim_plots.draw_selection(axes, results)
        return as_svg(
            figure, "What choosing the best checkpoint adds, against what it would add to equal ones"
        )


def _coordination(found: Reproduction) -> str:
    if not found.coordination:
        return ""
    with single_panel(7.2, 0.9 + 0.9 * len(found.coordination)) as (figure, axes):
        claim_plots.draw_coordination(axes, found.coordination)
        return as_svg(figure, "Episodes lost in uncoordinated and in coordinated subtasks")


def _signed(share: float, digits: int = 0) -> str:
    return f"{100 * share:+.{digits}f}".replace("-", "−")


def _span(seeds: Sequence[int]) -> str:
    return "–" if not seeds else str(seeds[0]) if len(seeds) == 1 else f"{seeds[0]} … {seeds[-1]}"
