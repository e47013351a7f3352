"""A reproduction as a printable file, by matplotlib alone: the tables, a figure for each claim, how it was made."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from mart.trainer.report import claim_plots, paper, plots
from mart.trainer.report.figures import LINE, QUIET, STYLE
from mart.trainer.report.reproduction import ReproducedTable, Reproduction
from mart.trainer.report.reproduction_page import (
    claim_row,
    missing_in_words,
    rows_and_columns,
    step_row,
    summary,
    table_cell,
    versions_of,
)

_A4_IN = (11.69, 8.27)  # across
_LINES = 44  # of a page of text
_WIDTH = 150  # characters
_MARGIN = 0.06  # of the page


def write_pdf(path: Path, found: Reproduction) -> None:
    """Write the report, page by page; a missing folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(fname=STYLE), PdfPages(path, metadata={"Title": "The paper, reproduced"}) as pages:
        for figure in _pages(found):
            pages.savefig(figure)


def _pages(found: Reproduction) -> Iterator[Figure]:
    for table in found.tables:
        yield _table_page(found, table)
        for _, tested in groupby(table.claims, key=lambda one: one.claim.name):
            listed = list(tested)
            words = [
                f"{row[0]}, {row[1]}: {row[2]} points, p {row[3]} over seeds and worlds, {row[4]} of these policies"
                for row in map(claim_row, listed)
            ]
            yield _drawn(listed[0].claim.sentence, [partial(claim_plots.draw_claim, tested=listed)], words)
        if table.results is not None:
            results = table.results
            yield _drawn(
                f"{table.title}: what choosing adds",
                [partial(claim_plots.draw_selection, results=results)],
                ["A dot a cell. On the dotted line, choosing among equal checkpoints explains all of it."],
            )
            for task in results.tasks:
                yield _drawn(
                    paper.TITLES.get(task, task),
                    [
                        partial(plots.draw_success, results=results, task=task),
                        partial(plots.draw_learning, results=results, task=task),
                    ],
                    [
                        "Filled: ours in fresh worlds, 95 % interval. Bar: ours, best checkpoint. Hollow: the paper."
                    ],
                )
    if found.coordination:
        yield _drawn(
            "Table I: what coordination costs operators",
            [partial(claim_plots.draw_coordination, rows=found.coordination)],
            ["Filled: ours, 95 % interval over episodes. Hollow: the paper."],
        )
    yield from _text("Missing, or not whole", [missing_in_words(cell) for cell in found.missing])
    yield from _text("How it was made", _appendix(found))


def _table_page(found: Reproduction, table: ReproducedTable) -> Figure:
    models, tasks = rows_and_columns(table)
    figure = _page(table.title)
    axes = figure.add_axes((_MARGIN, 0.14, 1 - 2 * _MARGIN, 0.7))
    axes.axis("off")
    cells = [[_cell(table, model, task) for task in tasks] for model in models]
    drawn = axes.table(
        cells,
        rowLabels=models,
        colLabels=[paper.TITLES.get(task, task) for task in tasks],
        loc="center",
        cellLoc="left",
        bbox=Bbox.from_bounds(0.09, 0.0, 0.91, 1.0),
    )
    drawn.auto_set_font_size(value=False)
    drawn.set_fontsize(9)
    for (row, column), cell in drawn.get_celld().items():
        cell.visible_edges = "B"
        cell.set_edgecolor(LINE)
        if row == 0 or column < 0:
            cell.set_text_props(weight="bold")
    figure.text(
        _MARGIN,
        0.06,
        f"{summary(found)}\nFirst line: best checkpoint, mean ± deviation over seeds. fresh: in worlds that had no "
        "part in choosing, 95 % interval over seeds and worlds.",
        color=QUIET,
        fontsize=9,
    )
    return figure


def _cell(table: ReproducedTable, model: str, task: str) -> str:
    shown = table_cell(table.results, table.name, model, task)
    lines = [shown["ours"] or "–", f"fresh {shown['fresh']}" if shown["fresh"] else ""]
    return "\n".join(filter(None, (*lines, f"paper {shown['paper']}" if shown["paper"] else "")))


def _drawn(title: str, draw: Sequence[Callable[[Axes], object]], words: Sequence[str]) -> Figure:
    figure = _page(title)
    height = 0.74 - 0.022 * len(words)
    for number, one in enumerate(draw):
        width = (1 - 2 * _MARGIN) / len(draw)
        one(
            figure.add_axes(
                (_MARGIN + 0.12 + number * width, 0.14 + 0.022 * len(words), width - 0.22, height)
            )
        )
    figure.text(_MARGIN, 0.05, "\n".join(words), color=QUIET, fontsize=9)
    return figure


def _text(title: str, lines: Sequence[str]) -> Iterator[Figure]:
    wrapped = [
        part for line in lines for part in textwrap.wrap(line, _WIDTH, subsequent_indent="    ") or [""]
    ]
    for first in range(0, len(wrapped), _LINES):
        figure = _page(title)
        figure.text(
            *(_MARGIN, 0.87, "\n".join(wrapped[first : first + _LINES])),
            va="top",
            fontsize=8,
            family="monospace",
            linespacing=1.4,
            parse_math=False,
        )
        yield figure


def _appendix(found: Reproduction) -> list[str]:
    lines = [f"Asked for: mart {' '.join(found.plan.asked)}", *versions_of(found.records), ""]
    for row in map(step_row, found.records.values()):
        lines += [
            f"{row['name']}: {row['status']}, {row['wall']}, seeds {row['seeds']}",
            f"  $ {row['command']}",
        ]
        lines += [f"  from {row['inputs']}; result {row['result']}", ""]
    return lines


def _page(title: str) -> Figure:
    figure = Figure(figsize=_A4_IN)
    figure.text(_MARGIN, 0.92, title, fontsize=15, weight="bold")
    return figure
