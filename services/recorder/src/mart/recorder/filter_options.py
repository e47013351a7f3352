"""Which episodes a command means: `--task`, `--outcome` and so on, as the filters of the episodes page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from mart.recorder.catalogue.episode_catalogue import LabelledEpisode

OUTCOMES = ("success", "failure", "discarded", "unspecified")
VERDICTS = ("verified", "diverged", "unverified")
ANY = "any"

Command = TypeVar("Command", bound=Callable[..., object])


def filters(outcome: str = ANY, verdict: str = ANY) -> Callable[[Command], Command]:
    """Options of a command, for `passing`. `outcome`, `verdict`: what it takes where nothing is said."""
    options = (
        click.option("--dataset", default="", help="Only of this data set."),
        click.option("--skill", default="", help="Only of scripts with this skill."),
        click.option("--operator", default="", help="Driven by human, policy, script, or somebody by name."),
        _words("--verdict", VERDICTS, verdict),
        _words("--outcome", OUTCOMES, outcome),
        click.option("--task", default="", help="Only of this task."),
    )

    def decorate(command: Command) -> Command:
        for option in options:
            command = option(command)
        return command

    return decorate


def passing(
    rows: Iterable[tuple[Path, LabelledEpisode]], wanted: Mapping[str, Any]
) -> list[tuple[Path, LabelledEpisode]]:
    """Those that the options let through, in their order."""
    from mart.protocol.messages import CatalogueRequest
    from mart.recorder.catalogue.listing import matches

    one_word = {name: wanted[name] for name in ("task", "operator", "skill", "dataset")}
    either = product(_all_or(wanted["outcome"]), _all_or(wanted["verdict"]))
    asked = [
        CatalogueRequest.List(outcome=outcome, verdict=verdict, **one_word) for outcome, verdict in either
    ]
    return [(path, row) for path, row in rows if any(matches(row, one) for one in asked)]


def _all_or(given: tuple[str, ...]) -> tuple[str, ...]:
    return ("",) if ANY in given else given


def _words(name: str, words: Iterable[str], usual: str) -> Callable[[Command], Command]:
    choice = click.Choice([*words, ANY])
    return click.option(name, type=choice, multiple=True, default=(usual,), help=f"[default: {usual}]")
