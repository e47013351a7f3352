"""Say on a command line how a data set goes to a hub: `--public` and `--push-over`, for exports and for pushes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import click

Command = TypeVar("Command", bound=Callable[..., object])


def hub_options(command: Command) -> Command:
    """Give a command `public` and `over`."""
    public = click.option("--public", is_flag=True, help="Of a hub: let everybody read what is made there.")
    over = click.option(
        "--push-over",
        "over",
        is_flag=True,
        help="Of a hub: replace what the data set holds there; its history keeps it.",
    )
    return public(over(command))
