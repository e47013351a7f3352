"""Say on a command line which episodes are meant: `--task`, `--outcome` and so on, as the filters of the pages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import click

from mart.protocol.vocabulary import EpisodeOutcome, Verdict

if TYPE_CHECKING:
    from mart.episodes.filter import EpisodeFilter

LABELS = (EpisodeOutcome.SUCCESS.value, EpisodeOutcome.FAILURE.value, EpisodeOutcome.DISCARDED.value)
OUTCOMES = (*LABELS, EpisodeOutcome.UNSPECIFIED.value)
VERDICTS = tuple(verdict.value for verdict in Verdict)
ANY = "any"

Command = TypeVar("Command", bound=Callable[..., object])


def filters(outcome: str = ANY, *verdicts: str) -> Callable[[Command], Command]:
    """Give a command the options that `filter_of` reads. outcome, verdicts: what it takes where nothing is said."""
    options = (
        click.option("--dataset", default="", help="Only of this data set."),
        click.option("--skill", default="", help="Only of scripts with this skill."),
        click.option(
            "--operator", default="", help="Driven by human, policy, script, generated, or somebody by name."
        ),
        word_option("--verdict", VERDICTS, *verdicts or (ANY,)),
        word_option("--outcome", OUTCOMES, outcome),
        click.option("--task", default="", help="Only of this task."),
    )

    def decorate(command: Command) -> Command:
        for option in options:
            command = option(command)
        return command

    return decorate


def filter_of(wanted: Mapping[str, Any], *, unusable: bool) -> EpisodeFilter:
    """Return the filter that the options ask for. unusable: whether it takes dropped and unreadable episodes too."""
    from mart.episodes.filter import EpisodeFilter

    def one(name: str) -> tuple[str, ...]:
        return (wanted[name],) if wanted.get(name) else ()

    return EpisodeFilter(
        tasks=one("task"),
        outcomes=_all_or(wanted["outcome"]),
        verdicts=_all_or(wanted["verdict"]),
        skills=one("skill"),
        datasets=one("dataset"),
        driven_by=wanted.get("operator", ""),
        unusable=unusable,
    )


def word_option(name: str, words: Iterable[str], *usual: str) -> Callable[[Command], Command]:
    """Return an option that takes one of `words` or `any`, several times; `usual` where nothing is said."""
    choice = click.Choice([*words, ANY])
    return click.option(
        name, type=choice, multiple=True, default=[*map(str, usual)], help=f"[default: {' and '.join(usual)}]"
    )


def _all_or(given: tuple[str, ...]) -> tuple[str, ...]:
    return () if ANY in given else given
