"""A trainer on the bus that trains nothing: jobs with curves and rollouts as a real one tells them."""

from __future__ import annotations

import contextlib
import math

from mart.protocol import codec, keys
from mart.protocol.errors import Conflict, MartError, NotFound
from mart.protocol.messages import (
    JOB_STATE_CANCELLED,
    JOB_STATE_DONE,
    JOB_STATE_QUEUED,
    JOB_STATE_RUNNING,
    Curve,
    DataSet,
    Evaluation,
    Job,
    JobProgress,
    JobState,
    Learned,
    Order,
    Rollout,
    SubtaskCount,
    TrainerReply,
    TrainerRequest,
    error_message,
)
from mart.protocol.messages import Policy as PromotedPolicy
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Bus, Request

TASK = "two_arm_multi_cube_lifting"
OTHER_TASK = "two_arm_drink_tray_lifting"
VIDEO = bytes(range(256)) * 16
_PIECE = 1000
_MODELS = (
    ("BC-RNN", "none", "joint", "none", "One network imitates all arms."),
    ("HBC", "joint", "joint", "none", "One plan, one actor for all arms."),
    ("d-HBC", "per-arm", "per-arm", "none", "Every arm plans and acts for itself."),
    ("dh-HBC", "per-arm", "joint", "none", "Each arm has its plan, one actor drives all."),
    ("dl-HBC", "joint", "per-arm", "none", "One plan, an actor for each arm."),
    ("r-HBC", "per-arm", "per-arm", "joint", "Every arm for itself, corrected by one that sees all."),
    ("rd-HBC", "joint", "joint", "per-arm", "All together, corrected arm by arm."),
    ("BC", "none", "joint", "none", "A plain network without memory."),
    ("d-Flow", "none", "per-arm", "none", "A chunk of actions at once, each arm for itself."),
)


class Trainer:
    """Open from its making until `close`."""

    def __init__(self, bus: Bus, jobs: bool = True) -> None:
        self.asked: list[TrainerRequest] = []
        self.jobs = _jobs() if jobs else []
        self.promoted: dict[str, PromotedPolicy] = {}
        self.rendered = False
        self.refusal = ""
        with contextlib.ExitStack() as opened:
            opened.enter_context(contextlib.closing(bus.serve(keys.training("trainer-1"), self._on_request)))
            opened.enter_context(
                contextlib.closing(bus.announce(keys.alive(ServiceKind.TRAINER, "trainer-1")))
            )
            self._opened = opened.pop_all()

    def close(self) -> None:
        self._opened.close()

    def _on_request(self, request: Request) -> None:
        asked = codec.decode(TrainerRequest, request.payload)
        self.asked.append(asked)
        try:
            reply = self._answer(asked)
        except MartError as error:
            reply = TrainerReply(error=error_message(error))
        request.reply(codec.encode(reply))

    def _answer(self, asked: TrainerRequest) -> TrainerReply:
        what = asked.WhichOneof("what") or ""
        reply: TrainerReply = getattr(self, f"_{what}")(getattr(asked, what))
        return reply

    def _choices(self, _: TrainerRequest.Choices) -> TrainerReply:
        return TrainerReply(choices=_choices())

    def _list(self, _: TrainerRequest.List) -> TrainerReply:
        return TrainerReply(jobs=self.jobs)

    def _show(self, show: TrainerRequest.Show) -> TrainerReply:
        return TrainerReply(details=_details(self._job(show.job)))

    def _logs(self, logs: TrainerRequest.Logs) -> TrainerReply:
        return TrainerReply(log=f"{self._job(logs.job).id}: update 100, loss 0.5\n".encode())

    def _cancel(self, cancel: TrainerRequest.Cancel) -> TrainerReply:
        return self._set_state(cancel.job, JOB_STATE_CANCELLED)

    def _retry(self, retry: TrainerRequest.Retry) -> TrainerReply:
        return self._set_state(retry.job, JOB_STATE_QUEUED)

    def _set_state(self, id: str, state: JobState) -> TrainerReply:
        job = self._job(id)
        job.state = state
        return TrainerReply(jobs=[job])

    def _policies(self, policies: TrainerRequest.Policies) -> TrainerReply:
        return TrainerReply(
            policies=[one for one in self.promoted.values() if policies.task in ("", one.task)]
        )

    def _withdraw(self, withdraw: TrainerRequest.Withdraw) -> TrainerReply:
        if withdraw.policy not in self.promoted:
            raise NotFound.named("policy", withdraw.policy, self.promoted)
        return TrainerReply(policies=[self.promoted.pop(withdraw.policy)])

    def _job(self, id: str) -> Job:
        for job in self.jobs:
            if job.id == id:
                return job
        raise NotFound.named("job", id, (job.id for job in self.jobs))

    def _submit(self, submit: TrainerRequest.Submit) -> TrainerReply:
        if self.refusal:
            raise Conflict(self.refusal)
        new: list[Job] = []
        for model in submit.models:
            order = Order(model=model, task=submit.tasks[0])
            order.data, order.preset = submit.order.data, submit.order.preset
            order.dataset = submit.order.dataset
            order.seeds.extend(submit.order.seeds)
            new.append(_job(f"job-{len(self.jobs) + len(new) + 1:04}", order, JOB_STATE_QUEUED, 0))
        self.jobs = [*new, *self.jobs]
        return TrainerReply(jobs=new)

    def _promote(self, promote: TrainerRequest.Promote) -> TrainerReply:
        if promote.name in self.promoted:
            raise Conflict(
                f"There is a policy {promote.name} already; choose another name or withdraw it first."
            )
        job = self._job(promote.job)
        evaluation = _details(job).evaluations[-1]
        policy = PromotedPolicy(
            name=promote.name,
            model=job.order.model,
            task=TASK,
            control_hz=20.0,
            arms=["arm0", "arm1"],
            joint=not job.order.model.startswith("d-"),
            updates=evaluation.updates,
            job=job.id,
            evaluation=evaluation,
        )
        self.promoted[policy.name] = policy
        return TrainerReply(policies=[policy])

    def _video(self, video: TrainerRequest.Video) -> TrainerReply:
        ready, self.rendered = self.rendered, True
        piece = VIDEO[video.offset : video.offset + _PIECE] if ready else b""
        return TrainerReply(video=TrainerReply.Video(ready=ready, piece=piece, size_bytes=len(VIDEO)))


def _choices() -> TrainerReply.Choices:
    models = [
        TrainerReply.Choices.Model(name=name, planner=planner, actor=actor, residual=residual, about=about)
        for name, planner, actor, residual, about in _MODELS
    ]
    order = Order(model="r-HBC", task=TASK, data="episodes", preset="fast", seeds=[0, 1, 2])
    order.evaluation_episodes = 30
    return TrainerReply.Choices(
        models=models,
        tasks=[TASK, OTHER_TASK],
        presets=["debug", "fast", "paper"],
        data=[
            DataSet(path="episodes", episodes=64, tasks=[TASK]),
            DataSet(path="episodes", name="cubes-good", episodes=58, left_out=2, tasks=[TASK]),
            DataSet(path="collected/episodes", episodes=100, tasks=[OTHER_TASK]),
        ],
        executors=["local"],
        device="cpu",
        order=order,
    )


def _jobs() -> list[Job]:
    def order(model: str) -> Order:
        return Order(model=model, task=TASK, data="episodes", preset="fast", seeds=[0, 1, 2])

    return [
        _job("job-0004", order("rd-HBC"), JOB_STATE_QUEUED, 0),
        _job("job-0003", order("r-HBC"), JOB_STATE_RUNNING, 3600, best=0.8),
        _job("job-0002", order("d-HBC"), JOB_STATE_DONE, 6000, best=0.87),
        _job("job-0001", order("BC-RNN"), JOB_STATE_DONE, 6000, best=0.4),
    ]


def _job(id: str, order: Order, state: JobState, updates: int, best: float = -1.0) -> Job:
    progress = JobProgress(
        updates=updates, updates_in_all=6000, updates_per_s=41.0, loss=0.02, best_success=best, stage="actor"
    )
    return Job(
        id=id, sweep="sweep-0001", order=order, state=state, executor="local", attempt=1, progress=progress
    )


def _details(job: Job) -> TrainerReply.Details:
    done = job.progress.updates
    steps = list(range(100, done + 1, 100))
    decay = 900.0 + 300.0 * len(job.order.model)
    curves = [
        Curve(
            name=name,
            updates=steps,
            values=[start * math.exp(-step / decay) + 0.01 * (1 + math.sin(step)) + 0.004 for step in steps],
        )
        for name, start in (("loss/actor", 0.6), ("loss/planner", 2.0))
    ]
    evaluations = [
        _evaluation(job, seed, updates, "selection")
        for updates in range(600, done + 1, 600)
        for seed in job.order.seeds
    ]
    if job.state == JOB_STATE_DONE:
        evaluations.append(_evaluation(job, job.order.seeds[0], done, "score"))
    learned = Learned(
        episodes=57,
        ticks=9120,
        sha256="1f6b0c9a2d3e4f50",
        dataset="cubes-good",
        dataset_episodes=58,
        left_out=["room-1-0007-two_arm_multi_cube_lifting.mcap (dropped)"],
    )
    return TrainerReply.Details(
        job=job,
        curves=curves,
        evaluations=evaluations,
        checkpoints=[one.checkpoint for one in evaluations],
        learned=learned if done else None,
    )


def _evaluation(job: Job, seed: int, updates: int, purpose: str) -> Evaluation:
    episodes = 100 if purpose == "score" else 30
    best = max(job.progress.best_success, 0.0)
    share = best * (1 - math.exp(-updates / 1500)) * (1 - 0.06 * seed)
    successes = round(episodes * share)
    return Evaluation(
        seed=seed,
        updates=updates,
        checkpoint=f"checkpoints/{updates}/seed-{seed}",
        purpose=purpose,
        episodes=episodes,
        successes=successes,
        low=max(0.0, share - 0.12),
        high=min(1.0, share + 0.1),
        failures=[SubtaskCount(name="cube0_lifted", episodes=episodes - successes)],
        rollouts=[Rollout(name="seed-7", seed=7, outcome="horizon", detail="cube0 lifted", time_s=15.0)],
    )
