from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

from mart.protocol.errors import Conflict
from mart.runtime import cli


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["mart", *arguments])
    with pytest.raises(SystemExit) as exit_:
        cli.main()
    assert isinstance(exit_.value.code, int)
    return exit_.value.code


def test_an_unknown_command_is_one_line_and_a_bad_exit_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, "teleport") != 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("mart: No such command 'teleport'")
    assert captured.err.count("\n") == 1
    assert run(monkeypatch, "rnu") != 0
    assert "Did you mean 'run'?" in capsys.readouterr().err


def test_commands_are_listed_by_what_they_are_for_and_none_is_left_out() -> None:
    told = CliRunner().invoke(cli.cli, ["--help"]).output
    titles = [line for line in told.splitlines() if line.endswith(":") and not line.startswith(" ")]
    assert titles == [
        "Options:",
        "A session:",
        "Episodes:",
        "Policies:",
        "Services, which `mart run` starts:",
    ]
    assert told.index("  driver ") < told.index("Episodes:")  # nothing starts it but a person
    for name in cli.cli.list_commands(click.Context(cli.cli)):
        assert f"\n  {name} " in told


def test_what_the_system_refuses_is_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    @click.command()
    def write() -> None:
        raise OSError(28, "No space left on device", "data/run")

    monkeypatch.setattr(cli.cli, "get_command", lambda ctx, name: write)
    assert run(monkeypatch, "write") == 1
    assert capsys.readouterr().err == "mart: data/run: No space left on device.\n"


def test_an_error_on_purpose_is_its_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    @click.command()
    def fail() -> None:
        raise Conflict("arm0 is held by Ana; choose another arm.")

    monkeypatch.setattr(cli.cli, "get_command", lambda ctx, name: fail)
    assert run(monkeypatch, "fail") == 1
    assert capsys.readouterr().err == "mart: arm0 is held by Ana; choose another arm.\n"


def test_a_result_is_one_json_object_or_words(capsys: pytest.CaptureFixture[str]) -> None:
    cli.print_result({"a": 1}, "a is 1", as_json=True)
    cli.print_result({"a": 1}, "a is 1", as_json=False)
    assert capsys.readouterr().out == '{"a": 1}\na is 1\n'
