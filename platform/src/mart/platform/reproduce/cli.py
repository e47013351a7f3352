"""`mart reproduce`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.platform.reproduce.runner import Outcome
    from mart.runtime.step_record import PlannedStep

_TABLES = ("table1", "table2", "table3")


def _listed(_context: click.Context, _option: click.Parameter, text: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in text.split(",") if word.strip())


@click.command()
@click.argument("table", type=click.Choice([*_TABLES, "all"]))
@click.option("--out", required=True, type=click.Path(path_type=Path, file_okay=False), help="Of everything.")
@click.option(
    "--data",
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="A folder with a folder of episodes for each task, in place of collecting.",
)
@click.option(
    "--preset", default="fast", show_default=True, type=click.Choice(["debug", "fast", "paper"]),
    help="debug: minutes; fast: a night of two cores; paper: published sizes, for a GPU.",
)  # fmt: skip
@click.option("--tasks", default="", callback=_listed, help="Separated by commas.  [default: the table's]")
@click.option("--models", default="", callback=_listed, help="Separated by commas.  [default: the table's]")
@click.option("--seeds", type=click.IntRange(1, 64), help="Of each training.  [default: 3; of paper 5]")
@click.option("--episodes", type=click.IntRange(1, 100_000), help="To collect of a task.  [default: 100]")
@click.option("--set", "changes", multiple=True, metavar="NAME=VALUE", help="As of `mart train`, for all.")
@click.option("--jobs", default=1, show_default=True, type=click.IntRange(1, 64), help="Steps at a time.")
@click.option("--redo", is_flag=True, help="Set aside, and make anew, what was made from something else.")
@click.option("--plan", "only_plan", is_flag=True, help="Only print the commands that would be run.")
@json_option
def reproduce(
    *, table: str, out: Path, jobs: int, redo: bool, only_plan: bool, as_json: bool, **given: Any
) -> int:
    """Make the paper's tables, from nothing or from data that is there: collect, train, judge, report.

    Can be stopped or killed at any time: the same command goes on where it was.
    """
    from mart.platform.reproduce.given_data import require_data
    from mart.platform.reproduce.plan import ReproductionOptions, steps_of
    from mart.platform.reproduce.runner import Runner
    from mart.runtime.service import stop_requested
    from mart.runtime.step_record import Plan, write_plan

    tables = _TABLES if table == "all" else (table,)
    data = given.pop("data")
    options = ReproductionOptions(tables, data=data.resolve() if data else None, **given)
    steps = steps_of(options)
    require_data(options, steps)
    if only_plan:
        commands = [f"mart {' '.join(step.command)}" for step in steps]
        print_result({"folder": str(out), "commands": commands}, "\n".join(commands), as_json)
        return 0
    folder = out.resolve()
    with stop_requested() as stop:
        runner = Runner(folder, steps, lambda line: click.echo(line, err=True), jobs=jobs, redo=redo)
        folder.mkdir(parents=True, exist_ok=True)
        write_plan(folder, Plan(asked=tuple(sys.argv[1:]), preset=options.preset, tables=tables, steps=steps))
        outcome = runner.run(stop)
    reported = _report(folder)
    result = {
        "folder": str(out),
        "complete": outcome.complete,
        "steps": {name: state.value for name, state in outcome.states.items()},
        "why": dict(outcome.why),
        "report": reported,
    }
    print_result(result, _in_words(out, outcome, steps, reported), as_json)
    return 130 if outcome.stopped else 0 if outcome.complete else 1


def _report(folder: Path) -> str:
    """Write the report of what is there; return where it is, or why there is none."""
    import subprocess

    from mart.runtime.child_process import MART

    made = subprocess.run(  # noqa: S603 - our own command
        [MART, "report", "paper", folder], capture_output=True, text=True, check=False
    )
    return (made.stdout if made.returncode == 0 else made.stderr).strip()


def _in_words(out: Path, outcome: Outcome, steps: tuple[PlannedStep, ...], reported: str) -> str:
    from mart.platform.reproduce.schedule import StepState

    done = sum(state is StepState.DONE for state in outcome.states.values())
    lines = [f"{done} of {len(steps)} steps are done in {out}."]
    for name, why in outcome.why.items():
        if outcome.states[name] is not StepState.DONE:
            lines.append(f"  {name}: {outcome.states[name].value}: {why}")
    if StepState.CHANGED in outcome.states.values():
        lines.append(
            "What was made from something else is left as it is; --redo sets it aside and makes it anew."
        )
    if not outcome.complete:
        lines.append("The same command goes on where this one was.")
    return "\n".join((*lines, reported))
