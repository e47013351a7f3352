"""Ask on the command line at which control rate episodes are taken."""

from __future__ import annotations

import click

from mart.protocol.control_rate import LEARNING_CONTROL_HZ, require_control_hz
from mart.protocol.errors import InvalidInput

OWN = "own"


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
