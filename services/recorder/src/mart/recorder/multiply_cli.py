"""Offer `mart multiply`.

Heavy modules are imported inside: `mart --help` loads this file.
"""

from __future__ import annotations

from pathlib import Path

import click

from mart.runtime.cli import json_option, print_result
from mart.runtime.progress import progress
from mart.runtime.task_option import task_option


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@task_option("two_arm_multi_cube_lifting")
@click.option(
    "--to", "wanted", type=click.IntRange(1, 100_000), required=True, help="How many are to be made."
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="The folder of what is made.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0, 2**32 - 1))
@click.option(
    "--first", type=click.IntRange(1, 1000), help="Take the oldest so many demonstrations.  [default: 1000]"
)
@click.option("--operator", default="", help="Driven by human, policy, script, or somebody by name.")
@click.option("--from-generated", is_flag=True, help="Take generated episodes, too.")
@click.option(
    "--replicas", default="", help="Running replicas, separated by commas.  [default: one of its own]"
)
@json_option
def multiply(
    *,
    paths: tuple[Path, ...],
    task: str,
    wanted: int,
    out: Path,
    seed: int,
    first: int | None,
    operator: str,
    from_generated: bool,
    replicas: str,
    as_json: bool,
) -> None:
    """Make many episodes of few: carry each part of a demonstration to where things lie in other worlds.

    What a task calls a success is kept, verified and marked as generated. The same command goes on where it was
    stopped.
    """
    from mart.recorder.multiply.multiplying import MultiplyOrder, multiplying

    order = MultiplyOrder(
        paths=paths,
        task=task,
        wanted=wanted,
        out=out,
        seed=seed,
        first=first,
        operator=operator,
        from_generated=from_generated,
        replicas=tuple(filter(None, replicas.split(","))),
    )
    attempts = kept = 0
    with progress("Episodes", wanted, as_json=as_json) as shown, multiplying(order) as (sources, batches):
        for batch in batches:
            attempts, kept = attempts + batch.attempts, kept + len(batch.kept)
            shown.reach(min(kept, wanted))
    demonstrations = len(sources.demonstrations)
    result = {
        "task": task,
        "demonstrations": demonstrations,
        "attempts": attempts,
        "kept": kept,
        "success_rate": round(kept / attempts, 4) if attempts else None,
        "out": str(out),
    }
    text = f"{kept} episodes were made of {demonstrations} demonstrations in {attempts} attempts. They are in {out}."
    print_result(result, text, as_json)
