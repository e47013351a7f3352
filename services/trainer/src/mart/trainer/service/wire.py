"""Jobs, evaluations and policies as they travel."""

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
from mart.trainer.data.dataset import Digest
from mart.trainer.evaluate import result
from mart.trainer.evaluate.result import MAX_ROLLOUTS, Evaluation, Played
from mart.trainer.evaluate.seeds import Purpose
from mart.trainer.jobs.job import Job, State
from mart.trainer.request import TrainRequest
from mart.trainer.runs import RunDirectory
from mart.trainer.service import metrics

MAX_LEFT_OUT = 200


def job_message(job: Job, data_dir: Path) -> JobMessage:
    """With its progress, from the files of its run."""
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
    """None until the run's data have been read."""
    if not run.data.is_file():
        return None
    digest = Digest.model_validate_json(run.data.read_bytes())
    learned = Learned(episodes=len(digest.episodes), ticks=digest.ticks, sha256=digest.sha256)
    if digest.dataset is not None:
        learned.dataset, learned.dataset_episodes = digest.dataset.name, digest.dataset.episodes
        told = (f"{Path(one.path).name} ({one.why})" for one in digest.dataset.left_out[:MAX_LEFT_OUT])
        learned.left_out.extend(told)
    return learned


def sweep_id(number: int) -> str:
    return f"sweep-{number:04}"


def evaluation_message(evaluation: Evaluation) -> EvaluationMessage:
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
        rollouts=[_rollout(played) for played in evaluation.played if played.rollout][:MAX_ROLLOUTS],
    )


def _order(job: Job) -> Order:
    request = job.request
    return Order(
        model=request.model,
        task=job.judging.task,
        data=str(_folder(request)),
        dataset=request.dataset.name if request.dataset else "",
        preset=request.preset,
        seeds=request.seeds,
        evaluation_episodes=job.judging.episodes,
        score_episodes=job.judging.score_episodes,
    )


def _folder(request: TrainRequest) -> Path:
    """Of its episodes; of a named data set the folder that names it."""
    first = request.data[0]
    if request.dataset:
        return labels.root_of(first)
    return first.parent if first.suffix else first


def _progress(job: Job, run: RunDirectory) -> JobProgress:
    newest = metrics.newest(run.metrics) if job.state is not State.QUEUED else {}
    selected = [found for found in result.read(run.evaluations) if found.purpose is Purpose.SELECTION]
    return JobProgress(
        updates=newest.get("updates", 0),
        updates_in_all=_updates_in_all(job),
        updates_per_s=newest.get("updates_per_s", 0.0),
        loss=newest.get("loss", 0.0),
        best_success=max((found.rate.value for found in selected), default=-1.0),
        stage=str(newest.get("stage", "")),
    )


def _updates_in_all(job: Job) -> int:
    hyperparameters = job.request.hyperparameters
    residual = hyperparameters.residual_updates if job.request.point.residual != "none" else 0
    return hyperparameters.updates + residual


def _counts(counts: Mapping[str, int]) -> Sequence[SubtaskCount]:
    return [SubtaskCount(name=name, episodes=number) for name, number in counts.items()]


def _rollout(played: Played) -> Rollout:
    missing = f"{len(played.done)} subtasks done" if played.outcome != "success" else ""
    return Rollout(
        name=played.rollout, seed=played.seed, outcome=played.outcome, detail=missing, time_s=played.time_s
    )
