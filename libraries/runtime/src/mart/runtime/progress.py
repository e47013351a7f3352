"""Show on a terminal how far a long command has come, and for how long it will go on.

Nothing is shown where nobody looks: with --json, or where standard error is no terminal.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypeVar

import click

T = TypeVar("T")

_ERASE_LINE = "\r\033[K"


class Progress:
    """A bar on standard error. Without one (`bar` is None) nothing is shown."""

    def __init__(self, bar: Any = None) -> None:
        self._bar = bar

    def advance(self, steps: int = 1) -> None:
        """Count so many steps more."""
        if self._bar is not None:
            self._bar.update(steps)

    def reach(self, steps: int) -> None:
        """Count up to so many steps in all."""
        if self._bar is not None:
            self._bar.update(steps - self._bar.pos)

    def say(self, line: str, *, err: bool = False) -> None:
        """Print a line above the bar; `advance` draws that again."""
        if self._bar is not None:
            click.echo(_ERASE_LINE, nl=False, err=True)
        click.echo(line, err=err)
        (sys.stderr if err else sys.stdout).flush()  # whoever reads a pipe hears of it now


@contextlib.contextmanager
def progress(label: str, steps: int, *, as_json: bool = False) -> Iterator[Progress]:
    """Show a bar while the block runs: `steps` in all, with the time left."""
    if as_json or not sys.stderr.isatty():
        yield Progress()
        return
    with click.progressbar(
        length=steps, label=label, show_pos=True, show_percent=False, file=sys.stderr
    ) as bar:
        yield Progress(bar)


def tracked(items: Sequence[T], label: str, *, as_json: bool = False) -> Iterator[T]:
    """Yield the items, and count each on a bar when the next is asked for."""
    with progress(label, len(items), as_json=as_json) as shown:
        yield from counted(items, shown)


def counted(items: Iterable[T], shown: Progress) -> Iterator[T]:
    """Yield the items, and count each when the next is asked for."""
    for item in items:
        yield item
        shown.advance()
