"""What is trained: orders, jobs with their curves, and policies that can take a seat."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field
from starlette.responses import JSONResponse, Response, StreamingResponse

from mart.protocol.messages import Order, TrainerReply, TrainerRequest
from mart.web.api.dependencies import App, BrowsingUser, WritingUser
from mart.web.api.texts import FilePath, Word
from mart.web.clients.message_json import as_json
from mart.web.clients.pieces import pieces_of
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api/training")


class Submission(BaseModel):
    """What shall be trained: one job for each model and task."""

    models: list[Word] = Field(min_length=1, max_length=16)
    tasks: list[Word] = Field(min_length=1, max_length=16)
    data: FilePath = ""
    dataset: Word = ""
    preset: Word = ""
    seeds: list[Annotated[int, Field(ge=0, lt=2**31)]] = Field(default_factory=list, max_length=64)
    evaluation_episodes: int = Field(0, ge=0, le=1000)
    score_episodes: int | None = Field(None, ge=0, le=1000)
    executor: Word = ""

    def request(self) -> TrainerRequest:
        """Return the trainer's request."""
        order = Order(
            data=self.data,
            dataset=self.dataset,
            preset=self.preset,
            seeds=self.seeds,
            evaluation_episodes=self.evaluation_episodes,
            score_episodes=self.score_episodes,
        )
        submit = TrainerRequest.Submit(
            models=self.models, tasks=self.tasks, order=order, executor=self.executor
        )
        return TrainerRequest(submit=submit)


class JobActionRequest(BaseModel):
    """What shall happen with a job."""

    action: Literal["cancel", "retry"]


class Promotion(BaseModel):
    """Which checkpoint becomes a policy, and its name."""

    job: Word
    name: Word
    checkpoint: FilePath = ""


@router.get("/choices")
async def choices(app: App, _user: BrowsingUser) -> Json:
    """Send what can be ordered.

    It is null where no trainer runs: that is no fault of a page that waits for one.
    """
    if not app.trainer.is_running:
        return {"choices": None}
    reply = await app.trainer.ask(TrainerRequest(choices=TrainerRequest.Choices()))
    return {"choices": as_json(reply.choices)}


@router.get("/jobs")
async def jobs(app: App, _user: BrowsingUser) -> Json:
    """Send all jobs."""
    reply = await app.trainer.ask(TrainerRequest(list=TrainerRequest.List()))
    return {"jobs": [as_json(job) for job in reply.jobs]}


@router.post("/jobs")
async def submit(body: Submission, app: App, _user: WritingUser) -> Json:
    """Submit jobs and send them."""
    reply = await app.trainer.ask(body.request())
    return {"jobs": [as_json(job) for job in reply.jobs]}


@router.get("/jobs/{job}")
async def show(job: str, app: App, _user: BrowsingUser) -> Json:
    """Send one job with its curves, evaluations and rollouts."""
    reply = await app.trainer.ask(TrainerRequest(show=TrainerRequest.Show(job=job)))
    return {"details": as_json(reply.details)}


@router.get("/jobs/{job}/log")
async def log(job: str, app: App, _user: BrowsingUser) -> Json:
    """Send what a job has printed."""
    reply = await app.trainer.ask(TrainerRequest(logs=TrainerRequest.Logs(job=job)))
    return {"log": reply.log.decode(errors="replace")}


@router.post("/jobs/{job}")
async def act(job: str, body: JobActionRequest, app: App, _user: WritingUser) -> Json:
    """Cancel a job or try it again, and send it."""
    request = TrainerRequest()
    getattr(request, body.action).job = job
    return {"jobs": [as_json(changed) for changed in (await app.trainer.ask(request)).jobs]}


@router.get("/jobs/{job}/videos/{rollout}")
async def video(job: str, rollout: str, app: App, _user: BrowsingUser) -> Response:
    """Send a rollout as MP4; 202 while it is being rendered: ask again."""

    async def piece(offset: int) -> TrainerReply.Video:
        request = TrainerRequest.Video(job=job, rollout=rollout, offset=offset)
        return (await app.trainer.ask(TrainerRequest(video=request))).video

    first = await piece(0)
    if not first.ready:
        return JSONResponse({"ready": False}, 202)
    return StreamingResponse(
        pieces_of(first, piece),
        media_type="video/mp4",
        headers={"Content-Length": str(first.size_bytes)},
    )


@router.get("/policies")
async def policies(app: App, _user: BrowsingUser, task: str = Query("")) -> Json:
    """Send the policies that can take a seat; there are none where no trainer runs."""
    if not app.trainer.is_running:
        return {"policies": []}
    reply = await app.trainer.ask(TrainerRequest(policies=TrainerRequest.Policies(task=task)))
    return {"policies": [as_json(policy) for policy in reply.policies]}


@router.post("/policies")
async def promote(body: Promotion, app: App, _user: WritingUser) -> Json:
    """Make a checkpoint a policy and send it."""
    request = TrainerRequest.Promote(job=body.job, checkpoint=body.checkpoint, name=body.name)
    reply = await app.trainer.ask(TrainerRequest(promote=request))
    return {"policies": [as_json(policy) for policy in reply.policies]}


@router.delete("/policies/{policy}")
async def withdraw(policy: str, app: App, _user: WritingUser) -> Json:
    """Withdraw a policy and send it."""
    request = TrainerRequest.Withdraw(policy=policy)
    reply = await app.trainer.ask(TrainerRequest(withdraw=request))
    return {"policies": [as_json(removed) for removed in reply.policies]}
