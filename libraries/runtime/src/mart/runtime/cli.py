"""The `mart` command: gathers the subcommands that installed parts register as entry points (`mart.commands`).

A failure is one line on standard error and an exit code that is not 0.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sys
import traceback
from collections.abc import Mapping
from difflib import get_close_matches
from importlib.metadata import entry_points
from typing import Any

import click

from mart.protocol.errors import MartError
from mart.runtime import steady_libm
from mart.runtime.stop_signals import stop_signals
from mart.runtime.supervision import SUPERVISOR_PID, end_with_supervisor

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object on standard output."
)


# What commands are for, in the order of a newcomer's needs; of parts that are not installed nothing is shown.
_PURPOSES = {
    "A session": ("run", "tasks", "arms", "driver", "stop", "doctor", "rooms", "ar-phone", "demo"),
    "Episodes": ("collect", "multiply", "episodes", "datasets"),
    "Policies": ("train", "eval", "report", "reproduce", "jobs", "operate"),
    "Services, which `mart run` starts": (
        *("router", "sim", "replica", "experts", "gateway", "phone", "recorder", "catalogue", "web"),
        *("trainer", "policies", "camera", "alive", "certificates"),
    ),
}
_HELP_WIDTH = 64
_NEAR = 0.6  # of 1: how alike a command must be to be meant


class Gathered(click.Group):
    """A group to which installed parts add subcommands, as entry points of `entry_group`.

    Loads one only when it is used: `mart --help` must not import a simulator.
    """

    def __init__(self, *args: Any, entry_group: str, **attributes: Any) -> None:
        super().__init__(*args, **attributes)
        self._entry_group = entry_group

    def list_commands(self, ctx: click.Context) -> list[str]:
        gathered = (entry.name for entry in entry_points(group=self._entry_group))
        return sorted({*super().list_commands(ctx), *gathered})

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Name the nearest command where there is none of that name."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            near = get_close_matches(args[0], self.list_commands(ctx), n=1, cutoff=_NEAR)
            meant = f"Did you mean {near[0]!r}?" if near else f"{ctx.command_path} --help lists them."
            raise click.UsageError(f"No such command {args[0]!r}. {meant}", ctx) from error

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        for entry in entry_points(group=self._entry_group, name=cmd_name):
            command = entry.load()
            assert isinstance(command, click.Command)
            return command
        return super().get_command(ctx, cmd_name)


class Grouped(Gathered):
    """The same with its commands listed by what they are for."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write a list for each purpose, and what belongs to none of them last."""
        left = self.list_commands(ctx)
        sections = [(title, [name for name in names if name in left]) for title, names in _PURPOSES.items()]
        known = {name for _, names in sections for name in names}
        for title, names in (*sections, ("Others", [name for name in left if name not in known])):
            commands = [(name, self.get_command(ctx, name)) for name in names]
            rows = [(name, command.get_short_help_str(_HELP_WIDTH)) for name, command in commands if command]
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows)


@click.group(
    cls=Grouped, entry_group="mart.commands", context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(package_name="mart-protocol", prog_name="mart")
def cli() -> None:
    """MART: collaborative teleoperation and imitation learning for multi-arm manipulation."""


def print_result(result: Mapping[str, Any], text: str, as_json: bool) -> None:
    """One JSON object, or the same in words for people."""
    click.echo(json.dumps(result) if as_json else text)


def main() -> None:
    steady_libm.begin_anew()
    end_with_supervisor()
    # Asked to end by a supervisor or a closed terminal, a command unwinds as on Ctrl-C: what it started is stopped.
    for number in stop_signals():
        signal.signal(number, signal.default_int_handler)
    try:
        code = cli(standalone_mode=False)
    except MartError as error:
        _fail(str(error), 1)
    except click.ClickException as error:
        _fail(error.format_message(), error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        _fail("Stopped.", 130)
    except BrokenPipeError:  # whoever read what we print has heard enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        if SUPERVISOR_PID in os.environ:  # a service's log tells all
            traceback.print_exc()
        _fail(_in_words(error), 1)
    else:
        sys.exit(code if isinstance(code, int) else 0)


def _in_words(error: OSError) -> str:
    """Return a sentence for a file or a device that failed."""
    reason = error.strerror or type(error).__name__
    return f"{error.filename}: {reason}." if error.filename else f"The system refused: {reason}."


def _fail(sentence: str, code: int) -> None:
    with contextlib.suppress(OSError):  # a terminal that was closed
        click.echo(f"mart: {sentence}", err=True)
    sys.exit(code)
