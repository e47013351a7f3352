"""A room's rate on the command line: a number, or left to the room."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

from mart.runtime.rate_option import room_rate_option


@click.command()
@room_rate_option
def command(control_hz: float | str | None) -> None:
    """Say what was given."""
    click.echo(repr(control_hz))


@pytest.mark.parametrize(
    ("words", "given"), [([], "None"), (["--control-hz", "auto"], "'auto'"), (["--control-hz", "30"], "30.0")]
)
def test_a_rate_is_given_or_left_to_the_room(words: list[str], given: str) -> None:
    assert CliRunner().invoke(command, words).output.strip() == given


@pytest.mark.parametrize("word", ["4", "101", "fast", "nan"])
def test_a_rate_that_no_room_has_is_refused(word: str) -> None:
    refused = CliRunner().invoke(command, ["--control-hz", word])
    assert refused.exit_code == 2
    assert "--control-hz" in refused.output
