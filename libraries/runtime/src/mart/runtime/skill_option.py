"""The option `--skill`: how each scripted person drives, one for all arms or one for each, with or without names."""

from __future__ import annotations

import re
from dataclasses import dataclass

import click

from mart.protocol.errors import InvalidInput, MartError, NotFound

# As the sim's scripts know them; a test holds the two together.
SKILLS = ("expert", "average", "novice", "hasty", "careful", "impatient", "learning")
SKILL_HELP = f"{', '.join(SKILLS)}; or one for each arm, separated by commas, as SKILL or NAME=SKILL."
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,31}")


@dataclass(frozen=True)
class ScriptedPerson:
    """Somebody who drives one arm by script. name: as files say it; empty for nobody in particular."""

    name: str
    skill: str


def parse_people(text: str, arms: int) -> tuple[ScriptedPerson, ...]:
    """Return who drives each arm: `expert` for all, or `ada=hasty,ben=careful`.

    Raises NotFound for an unknown skill, InvalidInput where the number is not that of the arms or a name cannot be one.
    """
    people = tuple(map(_person, text.split(",")))
    if len(people) == 1:
        people *= arms
    if len(people) != arms:
        raise InvalidInput(
            f"{len(people)} skills were given for {arms} arms; give one for all, or one for each."
        )
    return people


def require_people(_context: click.Context, _option: click.Parameter, value: str) -> str:
    """Return an option's value where it names people, however many; raises BadParameter."""
    try:
        parse_people(value, value.count(",") + 1)
    except MartError as error:
        raise click.BadParameter(str(error)) from error
    return value


def _person(text: str) -> ScriptedPerson:
    name, separator, skill = text.rpartition("=")
    if skill not in SKILLS:
        raise NotFound.named("skill", skill, SKILLS)
    if separator and not _NAME.fullmatch(name):
        raise InvalidInput(
            f"{name[:80]!r} cannot name a scripted person; use 1 to 32 letters, digits, '-' or '_'."
        )
    return ScriptedPerson(name, skill)
