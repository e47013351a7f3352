"""`mart eval`. Heavy modules are imported inside: `mart --help` loads this file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mart.protocol.errors import InvalidInput
from mart.runtime.cli import json_option, print_result
from mart.runtime.progress import Progress, progress

if TYPE_CHECKING:
    from mart.trainer.evaluate.config import EvalConfig
    from mart.trainer.evaluate.evaluation import Evaluation
    from mart.trainer.evaluate.evaluator import Evaluator


@click.command("eval")
@click.option(
    "--checkpoint",
    required=True,
    type=click.Path(path_type=Path),
    help="A checkpoint; or a run, whose checkpoints are all judged and the best ones scored in fresh worlds.",
)
@click.option("--task", help="Refuse checkpoints of another task.")
@click.option(
    "--episodes", default=30, show_default=True, type=click.IntRange(1, 10_000), help="Of a checkpoint."
)
@click.option(
    "--score-episodes",
    default=100,
    show_default=True,
    type=click.IntRange(0, 10_000),
    help="Of a run's best checkpoints, in fresh worlds; 0: none.",
)
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Decides the worlds.")
@click.option("--time-limit", type=click.FloatRange(0, 3600, min_open=True), help="Seconds of an episode.")
@click.option(
    "--replicas", default="", help="Running replicas, separated by commas.  [default: one is started]"
)
@click.option(
    "--keep", default=4, show_default=True, type=click.IntRange(0, 16), help="Failures that are kept."
)
@click.option("--device", default="cpu", show_default=True, help="Where the policy computes.")
@json_option
def evaluate(
    *,
    checkpoint: Path,
    task: str | None,
    episodes: int,
    score_episodes: int,
    seed: int,
    time_limit: float | None,
    replicas: str,
    keep: int,
    device: str,
    as_json: bool,
) -> None:
    """Judge a checkpoint, or a whole run, by episodes in worlds that every model is judged in."""
    from mart.rollouts.replicas import worlds
    from mart.trainer.evaluate import formatting
    from mart.trainer.evaluate.config import EvalConfig
    from mart.trainer.evaluate.evaluator import Evaluator

    config = EvalConfig(episodes, score_episodes, seed, time_limit, keep)
    names = [name for name in replicas.split(",") if name]
    if _is_foreign(checkpoint):
        _evaluate_foreign(checkpoint, task, config, names, device=device, as_json=as_json)
        return
    chosen = _chosen(checkpoint, task)
    with (
        worlds(names) as client,
        progress("Ticks", _ticks_ahead(chosen, config), as_json=as_json) as shown,
    ):
        evaluator = Evaluator(client, config, device, shown.advance)
        evaluations = _evaluated(evaluator, chosen, shown, as_json=as_json)
    result: dict[str, Any] = {"evaluations": [formatting.as_json(found) for found in evaluations]}
    print_result(result, formatting.summary(evaluations), as_json)


def _is_foreign(checkpoint: Path) -> bool:
    from mart.trainer.models.policies.find import is_foreign
    from mart.trainer.train.run_directory import SPEC_FILE

    return is_foreign(checkpoint) and not (checkpoint / SPEC_FILE).is_file()


def _evaluate_foreign(
    checkpoint: Path, task: str | None, config: EvalConfig, replicas: list[str], *, device: str, as_json: bool
) -> None:
    """Judge a policy that another project trained. Raises InvalidInput where it is for another task."""
    from mart.protocol.tasks import get_task
    from mart.rollouts.replicas import worlds
    from mart.trainer.evaluate import formatting
    from mart.trainer.evaluate.evaluator import Evaluator
    from mart.trainer.evaluate.rollouts import batch_count
    from mart.trainer.models.policies.find import load_any_policy

    policy = load_any_policy(checkpoint, device)
    if task not in (None, policy.task):
        raise InvalidInput(f"{checkpoint} was trained for {policy.task}, not for {task}; give one that was.")
    known = get_task(policy.task, len(policy.arms), policy.arm_kinds)
    ticks = round((config.time_limit_s or known.trial_limit_s) * policy.control_hz)
    with (
        worlds(replicas) as client,
        progress("Ticks", batch_count(1, config.episodes) * ticks, as_json=as_json) as shown,
    ):
        found = [Evaluator(client, config, device, shown.advance).evaluate_policy(policy, checkpoint)]
    result = {"evaluations": [formatting.as_json(one) for one in found]}
    print_result(result, formatting.summary(found), as_json)


def _chosen(checkpoint: Path, task: str | None) -> Path:
    """Looked at before worlds are started. Raises NotFound, Corrupt, InvalidInput."""
    from mart.trainer.evaluate.evaluator import require_task
    from mart.trainer.models.checkpoint import RECORD, read_record
    from mart.trainer.train.run_directory import SPEC_FILE, RunDirectory

    if (checkpoint / SPEC_FILE).is_file() and not (checkpoint / RECORD).is_file():
        run = RunDirectory(checkpoint)
        first = [
            run.checkpoint(updates, seed)
            for updates in run.checkpointed()[:1]
            for seed in run.seeds(updates)[:1]
        ]
    else:
        first = [checkpoint]
    for path in first:
        read_record(path)
        if task is not None:
            require_task(path, task)
    return checkpoint


def _ticks_ahead(chosen: Path, config: EvalConfig) -> int:
    """Return the ticks of all episodes that last as long as they may; what was judged before is not ahead."""
    from mart.protocol.tasks import get_task
    from mart.trainer.evaluate.rollouts import batch_count
    from mart.trainer.models.checkpoint import RECORD, read_record
    from mart.trainer.train.run_directory import RunDirectory

    if (chosen / RECORD).is_file():
        first, seeds, rounds = chosen, 1, 1
    else:
        run = RunDirectory(chosen)
        updates = run.checkpointed()
        if not updates:
            return 0
        seeds, rounds = len(run.seeds(updates[0])), len(updates)
        first = run.checkpoint(updates[0], run.seeds(updates[0])[0])
    record = read_record(first)
    task = get_task(record.task, len(record.arms), record.arm_kinds)
    limit_s = config.time_limit_s or task.trial_limit_s
    batches = rounds * batch_count(seeds, config.episodes)
    if rounds > 1 and config.score_episodes:
        batches += batch_count(seeds, config.score_episodes)
    return batches * round(limit_s * record.control_hz)


def _evaluated(evaluator: Evaluator, chosen: Path, shown: Progress, *, as_json: bool) -> list[Evaluation]:
    from mart.trainer.evaluate import formatting
    from mart.trainer.evaluate.evaluator import run_of
    from mart.trainer.evaluate.world_seeds import Purpose
    from mart.trainer.models.checkpoint import RECORD
    from mart.trainer.train.run_directory import RunDirectory

    def say(evaluation: Evaluation) -> None:
        if not as_json:
            shown.say(formatting.line(evaluation), err=True)

    if not (chosen / RECORD).is_file():
        run = RunDirectory(chosen)
        evaluator.evaluate_new(run, say)
        evaluator.score_best(run, say)
        return [*evaluator.known(run, Purpose.SELECTION), *evaluator.known(run, Purpose.SCORE)]
    run_or_none = run_of(chosen)
    kept_in = None if run_or_none is None else run_or_none.path / "rollouts"
    return evaluator.evaluate_checkpoints([chosen], Purpose.SELECTION, kept_in)
