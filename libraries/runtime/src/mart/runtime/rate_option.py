"""Ask on the command line at which control rate a room ticks, and at which episodes are taken, and how much of them."""

from __future__ import annotations

import math
from typing import Any

import click

from mart.protocol.control_rate import LEARNING_CONTROL_HZ, MAX_CONTROL_HZ, MIN_CONTROL_HZ, require_control_hz
from mart.protocol.errors import InvalidInput

OWN = "own"
AUTO = "auto"


def _rate(_context: click.Context, _option: click.Parameter, given: str) -> float | None:
    """Return a rate, or None for the episodes' own. Raises InvalidInput for what is none."""
    if given == OWN:
        return None
    try:
        return require_control_hz(float(given))
    except ValueError:
        raise InvalidInput(f"--control-hz {given} was given; give ticks a second, or {OWN}.") from None


control_hz_option = click.option(
    "--control-hz",
    default=f"{LEARNING_CONTROL_HZ:g}",
    show_default=True,
    metavar="HZ",
    callback=_rate,
    help=f"Take episodes in ticks of this rate, whatever theirs is; {OWN}: theirs, which must be one.",
)

skip_idle_option = click.option(
    "--skip-idle",
    "skip_idle_s",
    type=float,
    metavar="SECONDS",
    help="Leave out every stretch of at least so many seconds in which no arm moves.",
)


class _RoomRate(click.FloatRange):
    """Take ticks a second as a float, or AUTO, the word that leaves them to the room."""

    name = "rate"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == AUTO:
            return value
        rate_hz = super().convert(value, param, ctx)
        return rate_hz if math.isfinite(rate_hz) else self.fail(f"{value} is no rate.", param, ctx)


room_rate_option = click.option(
    "--control-hz",
    type=_RoomRate(MIN_CONTROL_HZ, MAX_CONTROL_HZ),
    metavar=f"HZ|{AUTO}",
    help=f"Ticks a second, at most; {AUTO}: the highest of 60, 30 and 20 that this machine holds.  [default: {AUTO}]",
)
