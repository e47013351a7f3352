"""What figures of the reports share: their style, dots with intervals, and how they become part of a page."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

QUIET, LINE, ACCENT = "#6b7280", "#d8dbe0", "#0072B2"  # as in calm.mplstyle and the pages
STYLE = Path(__file__).with_name("calm.mplstyle")
# Of lines that differ in kind: Okabe and Ito's colours, each with a dash of its own.
LINES = (
    ("#0072B2", "-"), ("#D55E00", "-"), ("#009E73", "-"), ("#CC79A7", "-"), ("#0072B2", "--"), ("#D55E00", "--"),
    ("#009E73", "--"), ("#CC79A7", "--"),
)  # fmt: skip


def draw_bar(axes: Axes, row: float, value: float, reach: tuple[float, float], *, filled: bool) -> None:
    """Draw a dot and how far it may be off, below and above: filled for ours, hollow for the paper's."""
    color = ACCENT if filled else QUIET
    axes.plot([value - reach[0], value + reach[1]], [row, row], color=color, linewidth=1.2)
    axes.plot(value, row, "o", color=color, markerfacecolor=color if filled else "white", markersize=6)


def label_rows(axes: Axes, labels: Sequence[str]) -> None:
    """Name the rows of a figure, the first on top."""
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.4, -0.6)
    axes.spines["left"].set_visible(False)
    axes.grid(axis="x")
    axes.set_axisbelow(True)


@contextmanager
def single_panel(width_in: float, height_in: float) -> Iterator[tuple[Figure, Axes]]:
    """Give one panel in the style of the reports."""
    with stacked_panels(width_in, (height_in,)) as (figure, (axes,)):
        yield figure, axes


@contextmanager
def stacked_panels(width_in: float, heights_in: Sequence[float]) -> Iterator[tuple[Figure, list[Axes]]]:
    """Give panels, one above the other, with the same x."""
    with mpl.rc_context(fname=STYLE):
        figure = Figure(figsize=(width_in, sum(heights_in)), layout="constrained")
        axes = figure.subplots(
            len(heights_in), sharex=True, squeeze=False, gridspec_kw={"height_ratios": heights_in}
        )
        yield figure, list(axes[:, 0])


def as_svg(figure: Figure, label: str) -> str:
    """Return the figure for use inside a page, with a name for those who do not see it."""
    stream = io.StringIO()
    figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = stream.getvalue()
    svg = text[text.index("<svg") :]
    return svg.replace("<svg", f'<svg role="img" aria-label="{label}"', 1)
