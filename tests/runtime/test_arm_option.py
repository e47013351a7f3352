from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

from mart.protocol.errors import InvalidInput
from mart.runtime.arm_option import arm_arguments, arm_kinds_option


@click.command()
@arm_kinds_option
def show(arm_kinds: dict[str, str]) -> None:
    click.echo(" ".join(arm_arguments(arm_kinds)))


def run(*words: str) -> str:
    return CliRunner().invoke(show, words, catch_exceptions=False).output.strip()


def test_kinds_are_chosen_by_arm_and_passed_on() -> None:
    assert not run()
    assert run("--arm", "arm1=ur5e", "--arm", "arm0=menagerie:kinova_gen3") == (
        "--arm arm0=menagerie:kinova_gen3 --arm arm1=ur5e"
    )


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["ur5e"], r"--arm ur5e was given; name an arm and its kind, such as --arm arm1=ur5e"),
        (["arm1="], r"name an arm and its kind"),
        (["arm1=ur5e", "arm1=gen3"], r"given twice for arm1: ur5e and gen3"),
    ],
)
def test_what_is_no_choice_is_said(words: list[str], says: str) -> None:
    with pytest.raises(InvalidInput, match=says):
        run(*(part for word in words for part in ("--arm", word)))
