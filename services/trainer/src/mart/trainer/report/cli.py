"""`mart report …`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

from pathlib import Path

import click

from mart.protocol.cli import json_option, print_result

_folder = click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))


@click.group()
def report() -> None:
    """The paper's tables and figures, from episodes and runs."""


@report.command()
@_folder
@json_option
def coordination(folder: Path, as_json: bool) -> None:
    """Table I: what coordinated and uncoordinated subtasks cost the operators of the episodes in FOLDER."""
    from mart.trainer.report import degradation
    from mart.trainer.report.attempts import read_attempts

    rows = [degradation.row(attempts.task, attempts.attempts) for attempts in read_attempts(folder)]
    print_result({"tasks": rows}, degradation.text(rows), as_json)
