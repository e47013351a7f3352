"""Pages: one file each, nothing to fetch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from mart.trainer.evaluate.evaluation import NOT_HELD
from mart.trainer.report import paper, plots
from mart.trainer.report.coupling import Coupling
from mart.trainer.report.results import Cell, Results

_NOT_HELD = "all done, not held"


def results_page(results: Results) -> str:
    """Return a page of tables and figures of what runs achieve."""
    models = sorted({model for task in results.tasks for model in results.models(task)}, key=_rank)
    cells = [cell for task in results.tasks for cell in results.cells[task].values()]
    numbers = sorted({len(cell.rates.seeds) for cell in cells})
    return render_page(
        "results.html",
        title=results.title,
        tasks=[_task(results, task) for task in results.tasks],
        rows=[
            {"model": model, "cells": [_cell(results, model, task) for task in results.tasks]}
            for model in models
        ],
        seeds=" to ".join(map(str, sorted({numbers[0], numbers[-1]}))),
        episodes=cells[0].rates.episodes,
    )


def dependence_page(couplings: Sequence[Coupling], model: str) -> str:
    """Return a page that draws how much arms depend on each other over an episode."""
    limits = plots.limits_percent(couplings)
    return render_page(
        "dependence.html",
        title="Dependence between arms",
        model=model,
        tasks=[
            {
                "title": coupling.task.title,
                "episodes": coupling.episodes,
                "overall": ", ".join(
                    f"{arm.name} {100 * own.overall:.1f} %" for arm, own in coupling.found.items()
                ),
                "figure": plots.dependences(coupling, limits),
            }
            for coupling in couplings
        ],
    )


def save(path: Path, page: str) -> None:
    """Write a page to a file; a missing folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page, encoding="utf-8")


def render_page(template: str, **values: Any) -> str:
    """Return a page of ours by the name of its template."""
    loader = PackageLoader("mart.trainer.report")
    environment = Environment(loader=loader, autoescape=select_autoescape(), undefined=StrictUndefined)
    return environment.get_template(template).render(**values)


def _rank(model: str) -> tuple[int, str]:
    known = list(paper.EXPERIENCED)
    return (known.index(model) if model in known else len(known), model)


def _task(results: Results, task: str) -> dict[str, Any]:
    return {
        "title": paper.TITLES.get(task, task),
        "success": plots.success(results, task),
        "learning": plots.learning(results, task),
        "failures": _failures(results.cells[task], results.models(task)),
    }


def _failures(cells: Mapping[str, Cell], models: Sequence[str]) -> dict[str, Any] | None:
    names = list(dict.fromkeys(name for model in models for name in cells[model].failures))
    if not names:
        return None
    rows = [
        (model, [f"{100 * cells[model].failures.get(name, 0.0):.0f}" for name in names]) for model in models
    ]
    titles = [_NOT_HELD if name == NOT_HELD else name for name in names]
    return {"names": titles, "rows": rows}


def _cell(results: Results, model: str, task: str) -> dict[str, Any]:
    cell, reported = results.cells[task].get(model), results.paper(model, task)
    shown: dict[str, Any] = {"ours": None, "fresh": "–", "best": False}
    if cell is not None:
        judged = cell.rates
        shown["ours"] = f"{100 * judged.paper.mean:.1f} ± {100 * judged.paper.deviation:.1f}"
        if judged.pooled is not None:
            low, high = judged.pooled.interval
            shown["fresh"] = f"{100 * judged.pooled.value:.1f} ({100 * low:.0f}–{100 * high:.0f})"
            shown["best"] = judged.pooled.value == max(
                other.rates.pooled.value for other in results.cells[task].values() if other.rates.pooled
            )
    shown["paper"] = "–" if reported is None else f"{reported.mean:.1f} ± {reported.deviation:.1f}"
    return shown
