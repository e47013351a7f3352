"""`mart trainer` and `mart jobs …`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from mart.protocol.control_rate import LEARNING_CONTROL_HZ
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.cli import json_option, print_result
from mart.runtime.rate_option import skip_idle_option

if TYPE_CHECKING:
    from mart.protocol.messages import TrainerReply, TrainerRequest

_trainer = click.option("--trainer", default="trainer-1", show_default=True, help="Which trainer service.")
_job = click.argument("job")
_LOOK_EVERY_S = 1.0
_SILENCE_S = 60.0  # of a trainer, while a sweep is waited for
_ASK_TIMEOUT_S = 30.0


def _listed(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


@click.command()
@click.option("--name", "trainer", help="Id of this trainer.  [default: trainer-1]")
@click.option("--slots", type=click.IntRange(1, 256), help="Jobs at a time on this machine.  [default: 1]")
@click.option("--ray", help="Address of a Ray cluster's head, like 10.0.0.5:6379.")
@click.option("--replicas", help="Running replicas to judge on.  [default: each job starts one]")
@click.option("--device", help="What trains: cpu or cuda.  [default: cpu]")
def trainer(**options: Any) -> None:
    """Take training jobs from the web page and from `mart jobs`, and see them through."""
    from mart.trainer.jobs.service.serve import serve_trainer
    from mart.trainer.jobs.service.settings import TrainerSettings

    serve_trainer(TrainerSettings(**{name: value for name, value in options.items() if value is not None}))


@click.group()
def jobs() -> None:
    """Training jobs on the trainer service."""


@jobs.command()
@click.option("--models", default="r-HBC", show_default=True, help="Separated by commas.")
@click.option("--tasks", required=True, help="Separated by commas.")
@click.option("--data", default="", help="Folder of episodes on the trainer's machine.  [default: episodes]")
@click.option("--dataset", default="", help="A named data set of that folder, whole.")
@click.option("--preset", default="fast", show_default=True, help="debug, fast or paper.")
@click.option(
    "--control-hz",
    default=LEARNING_CONTROL_HZ,
    show_default=True,
    type=float,
    help="Learn in ticks of this rate, whatever the episodes' is.",
)
@skip_idle_option
@click.option("--seeds", default=1, show_default=True, type=click.IntRange(1, 64), help="How many.")
@click.option("--seeds-per-job", default=0, type=click.IntRange(0, 64), help="0: all seeds in one job.")
@click.option(
    "--episodes", default=30, show_default=True, type=click.IntRange(0, 1000), help="Of a checkpoint."
)
@click.option(
    "--score-episodes",
    default=100,
    show_default=True,
    type=click.IntRange(0, 1000),
    help="Of the best checkpoint of each seed, in fresh worlds; 0: none.",
)
@click.option("--executor", default="", help="local or ray.  [default: local]")
@_trainer
@json_option
def submit(
    *,
    models: str,
    tasks: str,
    data: str,
    dataset: str,
    preset: str,
    control_hz: float,
    skip_idle_s: float | None,
    seeds: int,
    seeds_per_job: int,
    episodes: int,
    score_episodes: int,
    executor: str,
    trainer: str,
    as_json: bool,
) -> None:
    """Submit a sweep: one job for each model and task."""
    from mart.protocol.messages import Order, TrainerRequest

    order = Order(
        data=data,
        dataset=dataset,
        preset=preset,
        control_hz=control_hz,
        skip_idle_s=skip_idle_s or 0.0,
        seeds=range(seeds),
        evaluation_episodes=episodes,
        score_episodes=score_episodes,
    )
    wanted = TrainerRequest.Submit(
        models=_listed(models),
        tasks=_listed(tasks),
        order=order,
        seeds_per_job=seeds_per_job,
        executor=executor,
    )
    _print_jobs(_ask(trainer, TrainerRequest(submit=wanted)), as_json=as_json)


@jobs.command("list")
@click.option("--sweep", default="", help="Only of this one.")
@_trainer
@json_option
def list_jobs(sweep: str, trainer: str, as_json: bool) -> None:
    """List jobs, the newest first."""
    from mart.protocol.messages import TrainerRequest

    wanted = TrainerRequest.List(sweep=sweep)
    _print_jobs(_ask(trainer, TrainerRequest(list=wanted)), as_json=as_json)


@jobs.command()
@click.argument("sweep")
@_trainer
@json_option
def wait(sweep: str, trainer: str, as_json: bool) -> None:
    """Wait until every job of a sweep is over. Exits with 1 where one failed or was cancelled.

    A trainer that is away for less than a minute is asked again.
    """
    from mart.protocol import clock
    from mart.protocol.errors import NotFound, Unavailable
    from mart.protocol.messages import JOB_STATE_DONE, JOB_STATE_QUEUED, JOB_STATE_RUNNING, TrainerRequest

    wanted = TrainerRequest(list=TrainerRequest.List(sweep=sweep))
    reply = _ask(trainer, wanted)
    heard_s = clock.monotonic_s()
    while any(job.state in (JOB_STATE_QUEUED, JOB_STATE_RUNNING) for job in reply.jobs):
        clock.sleep_s(_LOOK_EVERY_S)
        try:
            reply, heard_s = _ask(trainer, wanted), clock.monotonic_s()
        except Unavailable:  # router and trainer may be started anew in the hours that a sweep takes
            if clock.monotonic_s() - heard_s > _SILENCE_S:
                raise
    if not reply.jobs:
        raise NotFound(f"There is no sweep {sweep!r} at {trainer}; `mart jobs list` shows them.")
    _print_jobs(reply, as_json=as_json)
    if any(job.state != JOB_STATE_DONE for job in reply.jobs):
        raise click.exceptions.Exit(1)


@jobs.command()
@_job
@_trainer
@json_option
def show(job: str, trainer: str, as_json: bool) -> None:
    """Show one job: how far it is, how its checkpoints do."""
    from mart.protocol.messages import TrainerRequest
    from mart.trainer.jobs.service import formatting

    reply = _ask(trainer, TrainerRequest(show=TrainerRequest.Show(job=job)))
    print_result(formatting.as_json(reply.details), formatting.details(reply.details), as_json)


@jobs.command()
@_job
@_trainer
@json_option
def logs(job: str, trainer: str, as_json: bool) -> None:
    """Print the end of what a job's process has said."""
    from mart.protocol.messages import TrainerRequest

    reply = _ask(trainer, TrainerRequest(logs=TrainerRequest.Logs(job=job)))
    text = reply.log.decode(errors="replace")
    print_result({"job": job, "log": text}, text.rstrip(), as_json)


@jobs.command()
@click.argument("job_or_sweep")
@_trainer
@json_option
def cancel(job_or_sweep: str, trainer: str, as_json: bool) -> None:
    """Cancel a job, or every job of a sweep. Checkpoints stay."""
    from mart.protocol.messages import TrainerRequest

    wanted = TrainerRequest.Cancel(job=job_or_sweep)
    _print_jobs(_ask(trainer, TrainerRequest(cancel=wanted)), as_json=as_json)


@jobs.command()
@_job
@_trainer
@json_option
def retry(job: str, trainer: str, as_json: bool) -> None:
    """Queue a failed or cancelled job anew; it goes on from its newest checkpoint."""
    from mart.protocol.messages import TrainerRequest

    _print_jobs(_ask(trainer, TrainerRequest(retry=TrainerRequest.Retry(job=job))), as_json=as_json)


@jobs.command()
@_job
@click.option("--name", required=True, help="Of the policy, as seats will know it.")
@click.option("--checkpoint", default="", help="Below the run's folder.  [default: the best one]")
@_trainer
@json_option
def promote(job: str, name: str, checkpoint: str, trainer: str, as_json: bool) -> None:
    """Give a checkpoint of a job a name under which it can take seats."""
    from mart.protocol.messages import TrainerRequest
    from mart.trainer.jobs.service import formatting

    wanted = TrainerRequest.Promote(job=job, name=name, checkpoint=checkpoint)
    (policy,) = _ask(trainer, TrainerRequest(promote=wanted)).policies
    print_result(formatting.as_json(policy), formatting.policy(policy), as_json)


def _ask(trainer: str, request: TrainerRequest) -> TrainerReply:
    """Ask the trainer. Raises what it answers, and Unavailable where none does."""
    from mart.protocol import codec, keys
    from mart.protocol.errors import Unavailable
    from mart.protocol.messages import TrainerReply
    from mart.runtime.ask import ask
    from mart.runtime.bus.zenoh_bus import ZenohBus
    from mart.runtime.settings import Settings

    with ZenohBus.connect(Settings().router, wait_for_router=False) as bus:
        if not bus.alive(keys.alive(ServiceKind.TRAINER, trainer)):
            raise Unavailable(f"No trainer {trainer!r} is up; start it with `mart trainer --name {trainer}`.")
        return ask(
            bus,
            keys.training(trainer),
            request,
            TrainerReply,
            _ASK_TIMEOUT_S,
            limit_bytes=codec.MAX_MESSAGE_BYTES,
        )


def _print_jobs(reply: TrainerReply, *, as_json: bool) -> None:
    from mart.trainer.jobs.service import formatting

    rows = [formatting.as_json(job) for job in reply.jobs]
    print_result({"jobs": rows}, formatting.table(reply.jobs), as_json)
