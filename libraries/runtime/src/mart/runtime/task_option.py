"""Ask on the command line which task: by its name, or as a task file, which every process started then knows."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import click

F = TypeVar("F", bound=Callable[..., object])


def _called(_context: click.Context, _option: click.Parameter, given: str | None) -> str | None:
    """Return the task's name. Raises NotFound and InvalidInput for a file that cannot be used."""
    from mart.protocol.tasks import task_called

    return None if given is None else task_called(given)


def task_option(default: str | None = None) -> Callable[[F], F]:
    """Return the option --task; without a default it may be left out."""
    return click.option(
        "--task",
        default=default,
        show_default=default is not None,
        callback=_called,
        metavar="NAME|FILE",
        help="`mart tasks` lists the names; or a task file of your own, NAME.toml.",
    )
