"""Rooms, their seats and their episodes."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from mart.protocol import clock
from mart.protocol.control_rate import MAX_CONTROL_HZ
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    OUTCOME_DISCARDED,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    RoomsRequest,
    operator_from_word,
)
from mart.protocol.tasks import get_task, task_names
from mart.web.lobby import Json, seat_json
from mart.web.routes.common import Joined, TheSite

router = APIRouter(prefix="/api")

_OUTCOMES = {"success": OUTCOME_SUCCESS, "failure": OUTCOME_FAILURE, "discard": OUTCOME_DISCARDED}


class NewRoom(BaseModel):
    task: str = Field(max_length=64)
    room: str = Field("", max_length=64)  # empty: a free name
    control_hz: float = Field(0.0, ge=0.0, le=MAX_CONTROL_HZ)  # 0: the usual rate
    episodes: int = Field(0, ge=0, le=10_000)  # good ones that are wanted; 0: no plan


class Take(BaseModel):
    operator: Literal["human", "policy", "script", "hold"]
    policy: str = ""  # a promoted one, where the operator is policy


class Act(BaseModel):
    action: Literal["ready", "unready", "success", "failure", "discard", "reset"]
    arm: str = ""


@router.get("/rooms")
async def rooms(site: TheSite, person: Joined) -> Json:
    return {"rooms": site.rooms.lobby.rooms_json(person.holder_id, clock.monotonic_s())}


@router.get("/tasks")
async def tasks(site: TheSite, _person: Joined) -> Json:
    return {"tasks": [_task_json(name) for name in task_names()], "opens_rooms": site.rooms.opens_rooms}


@router.post("/rooms")
async def open_room(body: NewRoom, site: TheSite, _person: Joined) -> Json:
    return {"room": await site.rooms.open(RoomsRequest.Open(**body.model_dump()))}


@router.get("/rooms/{room}/still")
async def still(room: str, site: TheSite, _person: Joined) -> Response:
    """The room's newest small picture. Whoever asks for another one gives another query: this one may be kept."""
    jpeg = site.rooms.lobby.stills.jpeg(room, clock.monotonic_s())
    return Response(jpeg, media_type="image/jpeg", headers={"Cache-Control": "private, max-age=60"})


@router.delete("/rooms/{room}")
async def close_room(room: str, site: TheSite, _person: Joined) -> Json:
    return {"room": await site.rooms.shut(room)}


@router.post("/rooms/{room}/seats/{arm}")
async def take_seat(room: str, arm: str, body: Take, site: TheSite, person: Joined) -> Json:
    if body.operator == "human":
        seat = await site.rooms.claim(room, arm, person)
    else:
        seat = await site.rooms.assign(room, arm, operator_from_word(body.operator), body.policy)
    return {"seat": seat_json(seat, person.holder_id)}


@router.delete("/rooms/{room}/seats/{arm}")
async def leave_seat(room: str, arm: str, site: TheSite, person: Joined) -> Json:
    return {"seat": seat_json(await site.rooms.release(room, arm, person), person.holder_id)}


@router.post("/rooms/{room}/seats/{arm}/hand-back")
async def hand_back(room: str, arm: str, site: TheSite, person: Joined) -> Json:
    """To the machine from which this person took over."""
    return {"seat": seat_json(await site.rooms.hand_back(room, arm, person), person.holder_id)}


@router.post("/rooms/{room}/episode")
async def act(room: str, body: Act, site: TheSite, person: Joined) -> Json:
    match body.action:
        case "ready" | "unready":
            if not body.arm:
                raise InvalidInput(
                    f"{body.action!r} was given without an arm; name the arm whose seat you hold."
                )
            await site.rooms.set_ready(room, body.arm, person, body.action == "ready")
        case "reset":
            await site.rooms.reset(room, person)
        case _:
            await site.rooms.finish(room, person, _OUTCOMES[body.action])
    return {"room": site.rooms.lobby.room_json(room, person.holder_id, clock.monotonic_s())}


def _task_json(name: str) -> Json:
    task = get_task(name)
    return {"name": name, "title": task.title, "instruction": task.instruction, "arms": len(task.arms)}
