"""Turn jobs, evaluations and what was learned from into messages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from mart.episodes import labels
from mart.protocol.messages import Evaluation as EvaluationMessage
from mart.protocol.messages import (
    Job as JobMessage,
)
from mart.protocol.messages import (
    JobProgress,
    Learned,
    Order,
    Rollout,
    SubtaskCount,
)
from mart.trainer.data.dataset import DataDigest
from mart.trainer.evaluate.evaluation import MAX_ROLLOUTS, EpisodeResult, Evaluation, read_evaluations
from mart.trainer.evaluate.world_seeds import Purpose
from mart.trainer.jobs.job import Job, JobState
from mart.trainer.jobs.service import curves
from mart.trainer.train.run_directory import RunDirectory
from mart.trainer.train.spec import TrainingSpec

MAX_LEFT_OUT = 200


def job_message(job: Job, data_dir: Path) -> JobMessage:
    """Return a job with its progress, which is read from the files of its run."""
    return JobMessage(
        id=job.id,
        sweep=sweep_id(job.sweep),
        order=_order(job),
        state=f"JOB_STATE_{job.state.upper()}",
        executor=job.executor,
        submitted_ns=job.submitted_ns,
        started_ns=job.started_ns,
        ended_ns=job.ended_ns,
        attempt=job.attempt,
        detail=job.detail,
        run=job.run,
        progress=_progress(job, RunDirectory(data_dir / job.run)),
    )


def learned_message(run: RunDirectory) -> Learned | None:
    """Return what a run learned from; None until its data have been read."""
    if not run.data.is_file():
        return None
    digest = DataDigest.model_validate_json(run.data.read_bytes())
    learned = Learned(
        episodes=len(digest.episodes),
        ticks=digest.ticks,
        sha256=digest.sha256,
        control_hz=digest.control_hz,
    )
    if digest.dataset is not None:
        learned.dataset, learned.dataset_episodes = digest.dataset.name, digest.dataset.episodes
        told = (f"{Path(one.path).name} ({one.why})" for one in digest.dataset.left_out[:MAX_LEFT_OUT])
        learned.left_out.extend(told)
    return learned


def sweep_id(number: int) -> str:
    """Return the name of a sweep, such as `sweep-0007`."""
    return f"sweep-{number:04}"


def evaluation_message(evaluation: Evaluation) -> EvaluationMessage:
    """Return an evaluation with its rate, interval, failures and kept rollouts."""
    low, high = evaluation.rate.interval
    return EvaluationMessage(
        seed=evaluation.seed,
        updates=evaluation.updates,
        checkpoint=evaluation.checkpoint,
        purpose=evaluation.purpose,
        episodes=evaluation.rate.trials,
        successes=evaluation.rate.hits,
        low=low,
        high=high,
        mean_success_time_s=evaluation.mean_success_time_s or 0.0,
        done=_counts(evaluation.done),
        failures=_counts(evaluation.failures),
        rollouts=[_rollout(result) for result in evaluation.played if result.rollout][:MAX_ROLLOUTS],
    )


def _order(job: Job) -> Order:
    training = job.spec.training
    return Order(
        model=training.model,
        task=job.spec.evaluation.task,
        data=str(_folder(training)),
        dataset=training.dataset.name if training.dataset else "",
        preset=training.preset,
        control_hz=training.control_hz or 0.0,
        skip_idle_s=training.selection.skip_idle_s or 0.0,
        seeds=training.seeds,
        evaluation_episodes=job.spec.evaluation.episodes,
        score_episodes=job.spec.evaluation.score_episodes,
    )


def _folder(training: TrainingSpec) -> Path:
    """Return the folder of the episodes; of a named data set the folder that names it."""
    first = training.data[0]
    if training.dataset:
        return labels.root_of(first)
    return first.parent if first.suffix else first


def _progress(job: Job, run: RunDirectory) -> JobProgress:
    newest = curves.newest_row(run.metrics) if job.state is not JobState.QUEUED else {}
    selected = [found for found in read_evaluations(run.evaluations) if found.purpose is Purpose.SELECTION]
    return JobProgress(
        updates=newest.get("updates", 0),
        updates_in_all=_updates_in_all(job),
        updates_per_s=newest.get("updates_per_s", 0.0),
        loss=newest.get("loss", 0.0),
        best_success=max((found.rate.value for found in selected), default=-1.0),
        stage=str(newest.get("stage", "")),
    )


def _updates_in_all(job: Job) -> int:
    training = job.spec.training
    hyperparameters = training.hyperparameters
    residual = hyperparameters.residual_updates if training.model_spec.residual != "none" else 0
    return hyperparameters.updates + residual


def _counts(counts: Mapping[str, int]) -> Sequence[SubtaskCount]:
    return [SubtaskCount(name=name, episodes=number) for name, number in counts.items()]


def _rollout(result: EpisodeResult) -> Rollout:
    missing = "" if result.succeeded else f"{len(result.done)} subtasks done"
    return Rollout(
        name=result.rollout, seed=result.seed, outcome=result.outcome, detail=missing, time_s=result.time_s
    )
