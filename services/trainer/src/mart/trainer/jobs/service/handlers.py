"""Answer requests to the trainer service, from the job table and the files of runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import TrainerReply, TrainerRequest
from mart.protocol.plain_text import require_plain
from mart.trainer.evaluate.evaluation import Evaluation, best_evaluation, read_evaluations
from mart.trainer.evaluate.world_seeds import Purpose
from mart.trainer.jobs.job import Job, JobSpec
from mart.trainer.jobs.job_files import LOG
from mart.trainer.jobs.queue import JobQueue
from mart.trainer.jobs.service import curves, promotion
from mart.trainer.jobs.service.options import training_options
from mart.trainer.jobs.service.serialization import evaluation_message, job_message, learned_message
from mart.trainer.jobs.service.settings import TrainerSettings
from mart.trainer.jobs.service.sweep import job_specs
from mart.trainer.jobs.service.videos import Videos
from mart.trainer.jobs.table import JobTable
from mart.trainer.train.run_directory import RunDirectory

MAX_TEXT_BYTES = 1024
MAX_JOBS = 200
MAX_EVALUATIONS = 500
MAX_LOG_BYTES = 64 * 1024
MAX_POLICIES = 200


class TrainerHandlers:
    """Answer requests. For one thread, but for `prepare`. executors: their names, the default first."""

    def __init__(
        self,
        settings: TrainerSettings,
        table: JobTable,
        queue: JobQueue,
        videos: Videos,
        *,
        executors: Sequence[str],
        now_ns: Callable[[], int],
    ) -> None:
        self._settings = settings
        self._table = table
        self._queue = queue
        self._videos = videos
        self._executors = executors
        self._now_ns = now_ns
        self._handlers: dict[str, Callable[[Any], TrainerReply]] = {
            "list": self._list,
            "show": self._show,
            "logs": self._logs,
            "cancel": self._cancel,
            "retry": self._retry,
            "promote": self._promote,
            "policies": self._policies,
            "withdraw": self._withdraw,
            "video": self._video,
        }

    def handle(self, request: TrainerRequest) -> TrainerReply:
        """Do what a request asks and return the reply. Raises errors of the tree."""
        return self.prepare(request)()

    def reads_folders(self, request: TrainerRequest) -> bool:
        """Tell whether `prepare` may take long, because it looks through folders of episodes."""
        return request.WhichOneof("what") in ("choices", "submit")

    def prepare(self, request: TrainerRequest) -> Callable[[], TrainerReply]:
        """Check a request, read what it needs of folders, and return what does it, for the thread of the jobs.

        Any thread may prepare a request that reads folders. Both steps raise errors of the tree.
        """
        _check_texts(request)
        what = request.WhichOneof("what")
        if what == "choices":
            choices = TrainerReply(choices=training_options(self._settings, self._executors))
            return lambda: choices
        if what == "submit":
            specs = job_specs(request.submit, self._settings)
            return lambda: self._submit(request.submit, specs)
        if what is None:
            known = ("choices", "submit", *self._handlers)
            raise InvalidInput(f"An empty request was given; ask for one of {', '.join(known)}.")
        return lambda: self._handlers[what](getattr(request, what))

    def _cancel(self, wanted: TrainerRequest.Cancel) -> TrainerReply:
        return self._jobs(self._queue.cancel(self._meant(wanted.job), self._now_ns()))

    def _retry(self, wanted: TrainerRequest.Retry) -> TrainerReply:
        return self._jobs([self._queue.retry(self._job(wanted.job))])

    def _policies(self, wanted: TrainerRequest.Policies) -> TrainerReply:
        found = promotion.policies(self._settings.policies_dir, wanted.task)
        return TrainerReply(policies=found[:MAX_POLICIES])

    def _withdraw(self, wanted: TrainerRequest.Withdraw) -> TrainerReply:
        return TrainerReply(policies=[promotion.withdraw(self._settings.policies_dir, wanted.policy)])

    def _submit(self, submit: TrainerRequest.Submit, specs: Sequence[JobSpec]) -> TrainerReply:
        executor = submit.executor or self._executors[0]
        return self._jobs(self._queue.submit(specs, executor, self._now_ns()))

    def _list(self, wanted: TrainerRequest.List) -> TrainerReply:
        limit = min(wanted.newest or MAX_JOBS, MAX_JOBS)
        sweep = _number(wanted.sweep, "sweep") if wanted.sweep else None
        return self._jobs(self._table.newest(limit, sweep))

    def _show(self, wanted: TrainerRequest.Show) -> TrainerReply:
        job = self._job(wanted.job)
        run = self._run(job)
        details = TrainerReply.Details(
            job=job_message(job, self._settings.data_dir),
            curves=curves.read_curves(run.metrics, wanted.since_updates),
            evaluations=[evaluation_message(e) for e in read_evaluations(run.evaluations)[-MAX_EVALUATIONS:]],
            checkpoints=_checkpoints(run)[-MAX_EVALUATIONS:],
            learned=learned_message(run),
        )
        return TrainerReply(details=details)

    def _logs(self, wanted: TrainerRequest.Logs) -> TrainerReply:
        path = self._run(self._job(wanted.job)).path / LOG
        size = min(wanted.tail_bytes or MAX_LOG_BYTES, MAX_LOG_BYTES)
        return TrainerReply(log=_tail(path, size))

    def _promote(self, wanted: TrainerRequest.Promote) -> TrainerReply:
        job = self._job(wanted.job)
        run = self._run(job)
        evaluations = read_evaluations(run.evaluations)
        checkpoint = wanted.checkpoint or _best_checkpoint(evaluations, job)
        if checkpoint not in _checkpoints(run):
            raise NotFound(
                f"{job.id} has no checkpoint {checkpoint!r}; `mart jobs show {job.id}` lists them."
            )
        policy = promotion.promote(
            self._settings.policies_dir,
            wanted.name,
            run.path / checkpoint,
            promotion.Origin(
                job.id, next((e for e in reversed(evaluations) if e.checkpoint == checkpoint), None)
            ),
            self._now_ns(),
        )
        return TrainerReply(policies=[policy])

    def _video(self, wanted: TrainerRequest.Video) -> TrainerReply:
        run = self._run(self._job(wanted.job))
        kept = {
            result.rollout
            for found in read_evaluations(run.evaluations)
            for result in found.played
            if result.rollout
        }
        if wanted.rollout not in kept:
            raise NotFound.named("rollout", wanted.rollout, kept)
        rollout = run.path / "rollouts" / f"{wanted.rollout}.mcap"
        return TrainerReply(video=self._videos.piece(rollout, wanted.offset))

    def _jobs(self, jobs: Sequence[Job]) -> TrainerReply:
        newest = sorted(jobs, key=lambda job: job.number, reverse=True)
        return TrainerReply(jobs=[job_message(job, self._settings.data_dir) for job in newest])

    def _meant(self, name: str) -> list[Job]:
        """Return the job of this name, or all of a sweep."""
        if not name.startswith("sweep-"):
            return [self._job(name)]
        found = self._table.newest(1_000_000, _number(name, "sweep"))
        if not found:
            raise NotFound(f"There is no sweep {name!r}; `mart jobs list` tells which there are.")
        return found

    def _job(self, name: str) -> Job:
        return self._table.get(_number(name, "job"))

    def _run(self, job: Job) -> RunDirectory:
        return RunDirectory(self._settings.data_dir / job.run)


def _checkpoints(run: RunDirectory) -> list[str]:
    """Return the checkpoints of all seeds, below the run's folder, the oldest first."""
    found = ((updates, seed) for updates in run.checkpointed() for seed in run.seeds(updates))
    return [run.checkpoint(*one).relative_to(run.path).as_posix() for one in found]


def _number(name: str, kind: str) -> int:
    digits = name.removeprefix(f"{kind}-")
    if digits == name or not digits.isdecimal() or len(digits) > 12:
        raise NotFound(f"There is no {kind} {name!r}; `mart jobs list` tells which there are.")
    return int(digits)


def _best_checkpoint(evaluations: Sequence[Evaluation], job: Job) -> str:
    """Return the checkpoint with the best score; where none was scored, the best that was selected."""
    for purpose in (Purpose.SCORE, Purpose.SELECTION):
        found = [evaluation for evaluation in evaluations if evaluation.purpose is purpose]
        if found:
            return best_evaluation(found).checkpoint
    raise NotFound(
        f"No checkpoint of {job.id} was judged; name one, as `mart jobs show {job.id}` lists them."
    )


def _tail(path: Path, size: int) -> bytes:
    if not path.is_file():
        return b""
    with path.open("rb") as file:
        file.seek(max(0, file.seek(0, 2) - size))
        return file.read(size)


def _check_texts(message: object) -> None:
    for field, value in getattr(message, "ListFields")():  # noqa: B009 - of any generated message
        values = value if field.is_repeated else [value]
        for one in values:
            if field.message_type is not None:
                _check_texts(one)
            elif isinstance(one, str):
                _check_text(field.name, one)


def _check_text(name: str, given: str) -> None:
    if len(given.encode()) > MAX_TEXT_BYTES:
        raise InvalidInput(
            f"{name} of {len(given.encode())} bytes was given; at most {MAX_TEXT_BYTES} are allowed."
        )
    require_plain(name, given)
