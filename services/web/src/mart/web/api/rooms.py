"""The API's rooms, their seats and their episodes."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Annotated, Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from mart.protocol import clock
from mart.protocol.arms import arm_kind, arm_kind_names, end_effector, end_effector_names
from mart.protocol.control_rate import require_control_hz
from mart.protocol.errors import InvalidInput, MartError
from mart.protocol.messages import (
    OUTCOME_DISCARDED,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    RoomsRequest,
    operator_from_word,
)
from mart.protocol.tasks import MAX_ARMS, arm_counts, arm_kinds_of, get_task, task_names
from mart.protocol.vocabulary import OperatorKind
from mart.web.api.dependencies import App, JoinedUser, WatchingUser, WritingUser
from mart.web.api.texts import Name, Word
from mart.web.lobby.room_json import Json, seat_json

router = APIRouter(prefix="/api")
_log = logging.getLogger(__name__)

_OUTCOMES = {"success": OUTCOME_SUCCESS, "failure": OUTCOME_FAILURE, "discard": OUTCOME_DISCARDED}


ArmKindName = Annotated[str, Field(pattern=r"^[a-z0-9_:+]{1,144}$")]


class NewRoom(BaseModel):
    """What room is wanted."""

    task: Name
    room: Name = ""  # empty: a free name
    control_hz: float = 0.0  # 0: as the machine holds
    episodes: int = Field(0, ge=0, le=10_000)  # good ones that are wanted; 0: no plan
    arms: int = Field(0, ge=0, le=MAX_ARMS)  # 0: as many as the task usually has
    arm_kinds: dict[Name, ArmKindName] = Field({}, max_length=MAX_ARMS)  # by arm, of those that are no Pandas
    practice: bool = False  # nothing is to be recorded in it
    course_required: bool = False  # people record who have passed the practice course


class TakeSeatRequest(BaseModel):
    """Who shall drive an arm."""

    operator: OperatorKind
    policy: Word = ""  # a promoted one, where the operator is policy


class EpisodeActionRequest(BaseModel):
    """What shall happen with the episode of a room."""

    action: Literal["ready", "unready", "success", "failure", "discard", "reset"]
    arm: Word = ""


@router.get("/rooms")
async def rooms(app: App, user: WatchingUser) -> Json:
    """Send all rooms as the user sees them."""
    return {"rooms": app.lobby.rooms_json(user.holder_id, clock.monotonic_s())}


@router.get("/tasks")
async def tasks(app: App, _user: JoinedUser) -> Json:
    """Send what a new room may be for, and whether anything here opens rooms."""
    return {
        "tasks": list(_tasks_json()),
        "arm_kinds": list(_arm_kinds_json()),
        "end_effectors": list(_end_effectors_json()),
        "opens_rooms": app.platform.is_running,
    }


@router.post("/rooms")
async def open_room(body: NewRoom, app: App, _user: WritingUser) -> Json:
    """Open a room and send its name."""
    if body.control_hz:
        require_control_hz(body.control_hz)
    return {"room": await app.platform.open_room(RoomsRequest.Open(**body.model_dump()))}


@router.get("/rooms/{room}/still")
async def still(room: str, app: App, _user: WatchingUser) -> Response:
    """Send the room's newest small picture.

    Whoever asks for another one gives another query: this one may be kept.
    """
    return _still(app.lobby.thumbnails.jpeg(room, clock.monotonic_s()))


@router.get("/rooms/{room}/seats/{arm}/still")
async def seat_still(room: str, arm: str, app: App, _user: WatchingUser) -> Response:
    """Send the newest small picture of a seat, as `still` does."""
    return _still(app.lobby.thumbnails.jpeg_of(room, arm, clock.monotonic_s()))


@router.delete("/rooms/{room}")
async def close_room(room: str, app: App, _user: WritingUser) -> Json:
    """Close a room and send its name."""
    return {"room": await app.platform.close_room(room)}


@router.post("/rooms/{room}/seats/{arm}")
async def take_seat(room: str, arm: str, body: TakeSeatRequest, app: App, user: JoinedUser) -> Json:
    """Give a seat to the user, to a machine or to nobody, and send it."""
    if body.operator is OperatorKind.HUMAN:
        seat = await app.rooms.take_seat(room, arm, user)
    else:
        seat = await app.rooms.assign_seat(room, arm, operator_from_word(body.operator), body.policy)
    return {"seat": seat_json(seat, user.holder_id)}


@router.delete("/rooms/{room}/seats/{arm}")
async def leave_seat(room: str, arm: str, app: App, user: JoinedUser) -> Json:
    """Free the user's seat and send it."""
    return {"seat": seat_json(await app.rooms.leave_seat(room, arm, user), user.holder_id)}


@router.post("/rooms/{room}/seats/{arm}/hand-back")
async def hand_back(room: str, arm: str, app: App, user: JoinedUser) -> Json:
    """Give a seat back to the machine from which the user took over, and send it."""
    return {"seat": seat_json(await app.rooms.hand_back_seat(room, arm, user), user.holder_id)}


@router.post("/rooms/{room}/seats/{arm}/switch")
async def switch(room: str, arm: str, app: App, user: JoinedUser) -> Json:
    """Give the user the next arm that no other person drives instead of this one, and send its seat."""
    return {"seat": seat_json(await app.switch_seat(room, arm, user), user.holder_id)}


@router.post("/rooms/{room}/episode")
async def act(room: str, body: EpisodeActionRequest, app: App, user: JoinedUser) -> Json:
    """Do what is wanted with the episode and send the room."""
    match body.action:
        case "ready" | "unready":
            if not body.arm:
                raise InvalidInput(
                    f"{body.action!r} was given without an arm; name the arm whose seat you hold."
                )
            await app.rooms.set_ready(room, body.arm, user, body.action == "ready")
        case "reset":
            await app.rooms.reset_world(room, user)
        case _:
            await app.rooms.finish_episode(room, user, _OUTCOMES[body.action])
    return {"room": app.lobby.room_json(room, user.holder_id, clock.monotonic_s())}


@router.post("/rooms/{room}/stop")
async def stop(room: str, app: App, user: JoinedUser) -> Json:
    """Stop everything in the room, until somebody lets go, and send the room."""
    await app.rooms.stop(room, user.holder_id, user.name)
    return {"room": app.lobby.room_json(room, user.holder_id, clock.monotonic_s())}


@router.delete("/rooms/{room}/stop")
async def let_go_of_stop(room: str, app: App, user: JoinedUser) -> Json:
    """Let everything go on, whoever stopped it, and send the room."""
    await app.rooms.let_go_of_stop(room, user.name)
    return {"room": app.lobby.room_json(room, user.holder_id, clock.monotonic_s())}


def _still(jpeg: bytes) -> Response:
    return Response(jpeg, media_type="image/jpeg", headers={"Cache-Control": "private, max-age=60"})


def _arm_kinds_json() -> Iterator[Json]:
    """Yield the kinds of arms whose files are here and can be read; what has to be fetched is for the terminal."""
    for name in arm_kind_names():
        try:
            kind = arm_kind(name)
        except MartError as error:
            _log.warning("New rooms are not offered %s: %s", name, error)
            continue
        if kind.mjcf is None or kind.mjcf.menagerie is None:
            yield {"name": name, "title": kind.title}


def _end_effectors_json() -> Iterator[Json]:
    """Yield what arms can hold at their ends, of those whose files can be read."""
    for name in end_effector_names():
        try:
            held = end_effector(name)
        except MartError as error:
            _log.warning("New rooms are not offered %s: %s", name, error)
            continue
        yield {"name": name, "title": held.title, "about": held.about}


def _tasks_json() -> Iterator[Json]:
    """Yield the tasks that can be read: people's own may have mistakes in their files."""
    for name in task_names():
        try:
            yield _task_json(name)
        except MartError as error:
            _log.warning("New rooms are not offered %s: %s", name, error)


def _task_json(name: str) -> Json:
    task = get_task(name)
    return {
        "name": name,
        "title": task.title,
        "instruction": task.instruction,
        "arms": len(task.arms),
        "arm_counts": list(arm_counts(name)),
        "arm_kinds": list(arm_kinds_of(name, None, {})),
    }
