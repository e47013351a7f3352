"""One figure for each claim, drawn into axes, so that a page and a printed report show the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes

from mart.trainer.report import paper
from mart.trainer.report.claims import ComparedClaim
from mart.trainer.report.figures import ACCENT, LINE, LINES, QUIET, draw_bar, label_rows
from mart.trainer.report.reproduction import HeldOutCurve
from mart.trainer.report.results import Results


def draw_claim(axes: Axes, tested: Sequence[ComparedClaim]) -> None:
    """Draw the differences of a claim's pairs, a row each: a dot with its 95 % interval, hollow the paper's."""
    for row, one in enumerate(tested):
        if one.reported is not None:
            draw_bar(axes, row + 0.18, 100 * one.reported, (0.0, 0.0), filled=False)
        value, (low, high) = one.comparison.difference.value, one.comparison.interval
        draw_bar(axes, row, 100 * value, (100 * (value - low), 100 * (high - value)), filled=True)
    label_rows(axes, [claim_label(one) for one in tested])
    axes.axvline(0, color=LINE, linewidth=1, zorder=0)
    axes.set_xlim(-103, 103)
    axes.set_xlabel("difference in success, percentage points")


def claim_label(one: ComparedClaim) -> str:
    """Return what a row of a claim is of: the pair and the task."""
    return f"{one.comparison.first} over {one.comparison.second}\n{paper.TITLES.get(one.task, one.task)}"


def draw_selection(axes: Axes, results: Results) -> None:
    """Draw what the best checkpoint shows above fresh worlds over what choosing alone would add, a dot a cell."""
    cells = [cell for of_task in results.cells.values() for cell in of_task.values()]
    points = [
        (100 * bias, 100 * (cell.rates.paper.mean - cell.rates.pooled.value))
        for cell in cells
        if cell.rates.pooled is not None and (bias := cell.selection_bias) is not None
    ]
    most = max([20.0, *(abs(value) for point in points for value in point)]) + 2
    axes.plot([0, most], [0, most], color=QUIET, linewidth=0.8, linestyle=(0, (1, 3)))
    axes.axhline(0, color=LINE, linewidth=1, zorder=0)
    axes.plot([x for x, _ in points], [y for _, y in points], "o", color=ACCENT, markersize=6, alpha=0.7)
    axes.set_xlim(-1, most)
    axes.set_ylim(-most, most)
    axes.set_xlabel("choosing among equal checkpoints would add, points")
    axes.set_ylabel("best checkpoint shows\nabove fresh worlds, points")


def draw_held_out(axes: Axes, curves: Sequence[HeldOutCurve]) -> None:
    """Draw losses on episodes that were not learned from, over training, a line a model."""
    for (color, dash), curve in zip(LINES, curves, strict=False):
        axes.plot(
            [u for u, _ in curve.points], [v for _, v in curve.points], dash, color=color, label=curve.model
        )
    axes.set_yscale("log")
    axes.set_xlabel("updates")
    axes.set_ylabel("held-out loss")
    axes.grid(axis="y")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def draw_coordination(axes: Axes, rows: Sequence[Mapping[str, Any]]) -> None:
    """Draw Table I: what uncoordinated and coordinated subtasks cost, two rows for each task, hollow the paper's."""
    labels: list[str] = []
    for row in rows:
        for kind in ("uncoordinated", "coordinated"):
            at, found = len(labels), row["degradation"][kind]
            labels.append(f"{row['title']}, {row['from']}\n{kind}")
            if row["paper"]:
                draw_bar(axes, at + 0.18, row["paper"][kind], (0.0, 0.0), filled=False)
            if found:
                reach = (found["value"] - found["low"], found["high"] - found["value"])
                draw_bar(axes, at, found["value"], reach, filled=True)
    label_rows(axes, labels)
    axes.set_xlim(-3, 103)
    axes.set_xlabel("episodes lost there, %")
