"""Figures as SVG that takes the page's own font. None needs its colours to be read: shapes and labels say the same."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mart.episodes.quality.comparison import COMPARED, ComparedGroup, judged_name
from mart.episodes.quality.outliers import JUDGED
from mart.protocol.tasks import Arm
from mart.trainer.report.coupling import Coupling
from mart.trainer.report.dependence import BINS
from mart.trainer.report.figures import (
    ACCENT,
    LINE,
    LINES,
    QUIET,
    STYLE,
    as_svg,
    draw_bar,
    label_rows,
    single_panel,
    stacked_panels,
)
from mart.trainer.report.results import Results

_MIDDLES = [100 * (i + 0.5) / BINS for i in range(BINS)]  # of the parts of an episode, in per cent
_MARKERS = {"circle": "o", "square": "s", "triangle": "^", "diamond": "D"}  # of an arm's symbol


def success(results: Results, task: str) -> str:
    """Draw ours in fresh worlds with its interval, ours by the paper's protocol, and the paper's; a row a model."""
    with single_panel(5.4, 0.9 + 0.36 * len(results.models(task))) as (figure, axes):
        draw_success(axes, results, task)
        return as_svg(figure, f"Success of each model on {task}")


def draw_success(axes: Axes, results: Results, task: str) -> None:
    """Draw what `success` does into axes."""
    models = results.models(task)
    for row, model in enumerate(models):
        cell, reported = results.cells[task][model], results.paper(model, task)
        judged, interval = cell.rates, cell.fresh_interval
        if reported is not None:
            draw_bar(axes, row + 0.16, reported.mean, (reported.deviation, reported.deviation), filled=False)
        axes.plot(100 * judged.paper.mean, row, "|", color=ACCENT, markersize=10, markeredgewidth=1.5)
        if judged.pooled is not None and interval is not None:
            mean = judged.pooled.value
            draw_bar(
                axes, row, 100 * mean, (100 * (mean - interval[0]), 100 * (interval[1] - mean)), filled=True
            )
    label_rows(axes, models)
    axes.set_xlim(-3, 103)
    axes.set_xlabel("success, %")


def learning(results: Results, task: str) -> str:
    """Draw the success of checkpoints over training, a line a model."""
    with single_panel(5.4, 3.2) as (figure, axes):
        draw_learning(axes, results, task)
        return as_svg(figure, f"Success over training on {task}")


def draw_learning(axes: Axes, results: Results, task: str) -> None:
    """Draw what `learning` does into axes."""
    for (color, dash), model in zip(LINES, results.models(task), strict=False):
        curve = results.cells[task][model].learning_curve
        axes.plot([u for u, _ in curve], [100 * rate for _, rate in curve], dash, color=color, label=model)
    axes.set_ylim(-3, 103)
    axes.set_xlabel("updates")
    axes.set_ylabel("success, %")
    axes.grid(axis="y")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def dependences(coupling: Coupling, limits_percent: tuple[float, float]) -> str:
    """Draw what an arm needs to know of the others over an episode; below, what a model uses.

    Equal limits compare tasks.
    """
    used = coupling.reliance
    with stacked_panels(7.2, (3.0, 2.0) if used else (3.2,)) as (figure, panels):
        need = panels[0]
        for arm, own in coupling.found.items():
            need.fill_between(
                _MIDDLES, 100 * own.low, 100 * own.high, color=arm.color, alpha=0.12, linewidth=0
            )
            need.plot(_MIDDLES, 100 * own.score, label=arm.name, **_line(arm))
        need.axhline(0, color=LINE, linewidth=1, zorder=0)
        need.set_ylim(*limits_percent)
        need.set_ylabel("error that knowing\nthe others removes, %")
        need.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        for name, share, coordinated in coupling.reached:
            _event(need, name, 100 * share, solid=coordinated)
        for panel in panels[1:]:
            for arm, shares in used.items():
                panel.plot(_MIDDLES, [100 * share for share in shares], **_line(arm))
            panel.set_ylim(0, None)
            panel.set_ylabel("what the model\ntakes from them, %")
        panels[-1].set_xlim(0, 100)
        panels[-1].set_xlabel("share of the episode, %")
        return as_svg(figure, f"Dependence on the other arms over an episode of {coupling.task.title}")


def ranges(groups: Sequence[ComparedGroup], task: str) -> str:
    """Draw each measure in a panel of its own, a row a group: a dot for the median, a line over the middle 80 %."""
    names = [name for name in COMPARED if _varies(groups, name)] or [*COMPARED[:1]]
    columns = 4
    down = -(-len(names) // columns)
    with mpl.rc_context(fname=STYLE):
        figure = Figure(figsize=(10.8, down * (0.9 + 0.3 * len(groups))), layout="constrained")
        panels = figure.subplots(down, columns, sharey=True, squeeze=False).flat
        for panel, name in zip(panels, names, strict=False):
            scale = 100 if JUDGED[name].unit == "%" else 1
            for row, group in enumerate(groups):
                if name in group.ranges:
                    found = group.ranges[name]
                    reach = (scale * (found.median - found.low), scale * (found.high - found.median))
                    draw_bar(panel, row, scale * found.median, reach, filled=True)
            label_rows(panel, [group.name for group in groups])
            panel.set_xlabel(judged_name(name))
        for panel in figure.axes[len(names) :]:
            panel.set_visible(False)
        return as_svg(figure, f"Measures of {task}, a row for each group; the table below has the numbers")


def _varies(groups: Sequence[ComparedGroup], name: str) -> bool:
    found = [group.ranges[name] for group in groups if name in group.ranges]
    return len({bound for one in found for bound in (one.low, one.high)}) > 1


def limits_percent(couplings: Sequence[Coupling]) -> tuple[float, float]:
    """Return the limits that hold what all of these tasks need."""
    values = [value for c in couplings for own in c.found.values() for value in (*own.low, *own.high)]
    return 100 * min(-0.1, *values) - 2, 100 * max(0.3, *values) + 2


def _line(arm: Arm) -> dict[str, Any]:
    return {"color": arm.color, "marker": _MARKERS[arm.symbol], "markersize": 5}


def _event(axes: Axes, name: str, at: float, *, solid: bool) -> None:
    """Draw an upright line with its name on top."""
    axes.axvline(at, color=QUIET, linewidth=0.8, linestyle="-" if solid else (0, (1, 3)))
    axes.annotate(
        name,
        (at, 1.0),
        (0, 4),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        rotation=30,
        fontsize=9,
        color=QUIET,
    )
