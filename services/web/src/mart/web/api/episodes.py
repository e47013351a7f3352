"""Recorded episodes: lists, one in detail, labels, and the files themselves. An episode is named by its path."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PurePosixPath
from typing import Annotated, Literal

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field
from starlette.responses import JSONResponse, Response, StreamingResponse

from mart.protocol.errors import Corrupt, MartError, NotFound, Unavailable
from mart.protocol.messages import CatalogueReply, CatalogueRequest, Edit, RecordedEpisode
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import EpisodeOutcome
from mart.web.api.app_state import AppState
from mart.web.api.dependencies import App, BrowsingUser, WritingUser
from mart.web.api.texts import FilePath, Word
from mart.web.clients.message_json import as_json
from mart.web.clients.pieces import pieces_of
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api")

Path = Annotated[FilePath, Query()]
Camera = Annotated[Word, Query()]


class CatalogueFilter(BaseModel):
    """Which episodes are wanted; each field is empty where all will do."""

    task: Word = ""
    outcome: Word = ""
    verdict: Word = ""
    operator: Word = ""
    room: Word = ""
    skill: Word = ""
    dataset: Word = ""
    outliers: bool = False  # only those of which something is unlike the others


class EpisodeListQuery(CatalogueFilter):
    """One page of the episodes that a filter lets through."""

    offset: int = Field(0, ge=0, lt=2**31)
    count: int = Field(50, ge=1, le=200)
    since_ns: int = Field(0, ge=0, lt=2**63)  # begun at or after this, Unix time


class LabelRequest(BaseModel):
    """What somebody says of an episode; what is absent stays as it is."""

    outcome: Literal[EpisodeOutcome.SUCCESS, EpisodeOutcome.FAILURE, EpisodeOutcome.DISCARDED] | None = None
    note: str | None = Field(None, max_length=2000)
    dropped: bool | None = None


class EditOfEpisode(BaseModel):
    """One edit; ticks are the recorded ones."""

    kind: Literal["cut", "skip", "split", "subtask"]
    value: Word


class EditRequest(BaseModel):
    """Edits of one act, and whether idle stretches of at least so many seconds are skipped, too; 0: none are."""

    edits: list[EditOfEpisode] = Field([], max_length=500)
    skip_idle_s: float = Field(0, ge=0, le=3600)


class UndoEditRequest(BaseModel):
    """Which act is taken back; 0: the newest act of edits."""

    act_ns: int = Field(0, ge=0, lt=2**63)


@router.get("/episodes")
async def episodes(asked: Annotated[EpisodeListQuery, Query()], app: App, _user: BrowsingUser) -> Json:
    """Send a page of the list of episodes.

    It is null where no catalogue runs: that is no fault of a page that waits for one.
    """
    if not app.catalogue.is_running:
        return {"listing": None}
    request = CatalogueRequest(list=CatalogueRequest.List(**asked.model_dump()))
    listing = (await app.catalogue.ask(request)).listing
    page = [episode_json(episode) for episode in listing.episodes]
    titles = {task: _title(task) for task in listing.tasks}
    return {"listing": as_json(listing) | {"episodes": page, "tasks": titles}}


@router.get("/episode")
async def episode(path: Path, app: App, _user: BrowsingUser) -> Json:
    """Send one episode in detail."""
    request = CatalogueRequest(show=CatalogueRequest.Show(path=path))
    details = (await app.catalogue.ask(request)).details
    titles = _subtask_titles(details.episode)
    told = as_json(details) | {"episode": episode_json(details.episode)}
    for lane in told["lanes"]:
        lane["title"] = titles.get(lane["name"], lane["name"])
    return {"details": told}


@router.post("/episode")
async def label(path: Path, body: LabelRequest, app: App, user: WritingUser) -> Json:
    """Write down what somebody says of an episode."""
    said = body.model_dump(exclude_none=True)
    request = CatalogueRequest(label=CatalogueRequest.Label(path=path, by=user.name, **said))
    labelled = (await app.catalogue.ask(request)).episode
    if body.outcome is not None:
        app.lobby.see_label(labelled.path, body.outcome)
    return {"episode": episode_json(labelled)}


@router.get("/episode/edits")
async def edits(path: Path, app: App, _user: BrowsingUser) -> Json:
    """Send how an episode is edited now."""
    return await _edited(app, CatalogueRequest(edit=CatalogueRequest.EditEpisode(path=path)))


@router.post("/episode/edits")
async def edit(path: Path, body: EditRequest, app: App, user: WritingUser) -> Json:
    """Write down what of an episode is left out, split or told otherwise."""
    asked = CatalogueRequest.EditEpisode(
        path=path,
        edits=(Edit(kind=one.kind, value=one.value) for one in body.edits),
        skip_idle_s=body.skip_idle_s,
        by=user.name,
    )
    return await _edited(app, CatalogueRequest(edit=asked))


@router.post("/episode/edits/undo")
async def undo_edit(path: Path, body: UndoEditRequest, app: App, user: WritingUser) -> Json:
    """Take back one act of an episode, whoever did it."""
    asked = CatalogueRequest.UndoEdit(path=path, act_ns=body.act_ns, by=user.name)
    return await _edited(app, CatalogueRequest(undo_edit=asked))


@router.get("/episode/file")
async def file(path: Path, app: App, _user: BrowsingUser) -> Response:
    """Send the episode file itself."""
    name = PurePosixPath(path).name.replace('"', "")
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    return await _whole(
        app,
        lambda offset: CatalogueRequest(file=CatalogueRequest.File(path=path, offset=offset)),
        "application/octet-stream",
        headers,
    )


@router.get("/episode/video")
async def video(path: Path, camera: Camera, app: App, _user: BrowsingUser) -> Response:
    """Send what one camera saw, as it was recorded, else as it is drawn: MP4; 202 while it is drawn: ask again."""

    def request(offset: int) -> CatalogueRequest:
        return CatalogueRequest(video=CatalogueRequest.Video(path=path, camera=camera, offset=offset))

    return await _whole(app, request, "video/mp4")


@router.get("/episode/picture")
async def picture(path: Path, app: App, _user: BrowsingUser) -> Response:
    """Send the last picture, recorded or drawn, small; an empty answer where there is none that can be shown."""
    try:
        reply = await app.catalogue.ask(CatalogueRequest(picture=CatalogueRequest.Picture(path=path)))
    except (NotFound, Corrupt, Unavailable):
        return Response(status_code=204)
    return Response(reply.piece.piece, media_type="image/jpeg")


async def _edited(app: AppState, request: CatalogueRequest) -> Json:
    edited = (await app.catalogue.ask(request)).edited
    return {"edited": as_json(edited) | {"episode": episode_json(edited.episode)}}


async def _whole(
    app: AppState,
    request: Callable[[int], CatalogueRequest],
    media_type: str,
    headers: dict[str, str] | None = None,
) -> Response:
    """What comes over the bus in pieces, as one answer. `request`: for the piece that begins at an offset."""

    async def piece(offset: int) -> CatalogueReply.Piece:
        return (await app.catalogue.ask(request(offset))).piece

    first = await piece(0)
    if first.pending:
        return JSONResponse({"ready": False}, 202)
    sized = {"Content-Length": str(first.size_bytes)} | (headers or {})
    return StreamingResponse(pieces_of(first, piece), media_type=media_type, headers=sized)


def episode_json(episode: RecordedEpisode) -> Json:
    """Return an episode as the pages take it."""
    told = as_json(episode)
    return told | {
        "title": _title(episode.task),
        "started_ms": episode.started_ns // 1_000_000,
        "real_time_factor": told.get("real_time_factor"),
    }


def _title(task: str) -> str:
    try:
        return get_task(task).title
    except MartError:  # recorded by a newer sim than this service, or a task file that is not here
        return task.replace("_", " ") or "Unknown task"


def _subtask_titles(episode: RecordedEpisode) -> dict[str, str]:
    try:
        task = get_task(episode.task, len(episode.operators) or None)
    except MartError:
        return {}
    return {subtask.name: subtask.title for subtask in task.subtasks}
