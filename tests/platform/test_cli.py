from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from mart.protocol.errors import InvalidInput, MartError, NotFound, Unavailable
from mart.runtime.cli import cli
from mart.runtime.ports import free_port
from tests.support.drawer_demonstration import TASK_FILE


def failure(command: str, *arguments: str) -> MartError:
    result = CliRunner().invoke(cli, [command, *arguments])
    assert isinstance(result.exception, MartError)
    return result.exception


def test_an_unknown_task_lists_the_known_ones() -> None:
    assert isinstance(failure("run", "--task", "two_arm_multi_cube_lift"), NotFound)
    assert "two_arm_multi_cube_lifting" in str(failure("collect", "--task", "nothing"))


def test_the_option_says_where_tasks_are_listed() -> None:
    assert "mart tasks" in CliRunner().invoke(cli, ["run", "--help"]).output


def test_a_task_file_can_be_given_and_is_told_what_is_wrong_in_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("MART_TASK_FILES", "")
    wrong = tmp_path / TASK_FILE.name
    wrong.write_text(TASK_FILE.read_text().replace("[success]", "[sucess]"))
    assert "sucess" in str(failure("run", "--task", str(wrong)))
    assert isinstance(failure("collect", "--task", str(tmp_path / "none.toml")), NotFound)
    assert "3 operators" in str(
        failure("collect", "--task", str(TASK_FILE), "--operators", "script,script,script")
    )


@pytest.mark.parametrize(
    ("operators", "kind"),
    [
        ("script", InvalidInput),
        ("script,script,script", InvalidInput),
        ("script,robot", NotFound),
        ("script,policy:nowhere", NotFound),
    ],
)
def test_wrong_operators_are_refused_before_anything_starts(operators: str, kind: type[MartError]) -> None:
    assert type(failure("collect", "--operators", operators)) is kind


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--skill", "master"),
        ("--episodes", "0"),
        ("--seed", "-1"),
        ("--seed", str(2**32)),
        ("--time-limit", "0"),
    ],
)
def test_what_cannot_be_collected_is_refused_in_one_line(option: str, value: str) -> None:
    result = CliRunner().invoke(cli, ["collect", "--lockstep", option, value])
    assert result.exit_code == 2
    (sentence,) = [line for line in result.output.splitlines() if line.startswith("Error")]
    assert value in sentence
    assert option in sentence


def test_without_a_router_commands_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MART_ROUTER", f"tcp/127.0.0.1:{free_port()}")
    for command in (["rooms"], ["alive", "sim"]):
        assert isinstance(failure(*command), Unavailable)
    result = CliRunner().invoke(cli, ["doctor", "--json"])
    assert result.exit_code == 1
    assert json.loads(result.output)["ok"] is False
