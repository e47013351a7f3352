"""Ask on the command line which arms are of another kind than a Panda."""

from __future__ import annotations

import re
from collections.abc import Mapping

import click

from mart.protocol.errors import InvalidInput

_CHOICE = re.compile(r"(arm[0-9])=(\S+)")


def _chosen(_context: click.Context, _option: click.Parameter, given: tuple[str, ...]) -> dict[str, str]:
    """Return the kind of each arm that was named. Raises InvalidInput for what is no choice, or two for one arm."""
    chosen: dict[str, str] = {}
    for text in given:
        found = _CHOICE.fullmatch(text)
        if found is None:
            raise InvalidInput(
                f"--arm {text} was given; name an arm and its kind, such as --arm arm1=ur5e. `mart arms list` has them."
            )
        arm, kind = found.groups()
        if chosen.setdefault(arm, kind) != kind:
            raise InvalidInput(f"--arm was given twice for {arm}: {chosen[arm]} and {kind}; leave one out.")
    return chosen


arm_kinds_option = click.option(
    "--arm",
    "arm_kinds",
    multiple=True,
    metavar="ARM=KIND",
    callback=_chosen,
    help="Another kind of arm than a Panda, such as arm1=ur5e; `mart arms list` names them. Can be given again.",
)


def arm_arguments(chosen: Mapping[str, str]) -> list[str]:
    """Return the same choice as arguments of a command."""
    return [word for arm, kind in sorted(chosen.items()) for word in ("--arm", f"{arm}={kind}")]
