"""What a host may do: whoever gave the host code. Guests and spectators are refused, in words."""

from __future__ import annotations

import asyncio
from typing import Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from mart.protocol import clock
from mart.protocol.errors import Forbidden
from mart.protocol.messages import OUTCOME_DISCARDED, OUTCOME_FAILURE, OUTCOME_SUCCESS
from mart.web.access.join_code import check_host_code
from mart.web.access.user_sessions import User
from mart.web.api.app_state import AppState
from mart.web.api.auth import set_cookie
from mart.web.api.dependencies import Address, App, HostingUser, MaybeUser, now_unix_s
from mart.web.lobby.room_json import Json, seat_json

router = APIRouter(prefix="/api")

_OUTCOMES = {"success": OUTCOME_SUCCESS, "failure": OUTCOME_FAILURE, "discard": OUTCOME_DISCARDED}
_NAMELESS = "Host"


class HostRequest(BaseModel):
    """The host code, and from somebody who has not joined the name under which others shall see them."""

    code: str
    name: str = ""


class HostEpisodeRequest(BaseModel):
    """How the episode of a room ends for all; reset: back to practice."""

    action: Literal["success", "failure", "discard", "reset"]


class PlanRequest(BaseModel):
    """How many good episodes are wanted from now on; 0: no plan."""

    episodes: int = Field(ge=0, le=10_000)


class CourseRequest(BaseModel):
    """Whether people must have passed the practice course before they record."""

    required: bool


@router.post("/host")
async def become_host(
    body: HostRequest, response: Response, app: App, known: MaybeUser, address: Address
) -> User:
    """Let whoever gives the host code host; somebody who joined keeps name and seats, anybody else joins by it.

    After five wrong host codes from an address the answers to it take longer, whoever asks.
    """
    await asyncio.sleep(app.wrong_host_codes.delay_s(address, clock.monotonic_s()))
    _require_host_code(app, body.code, address)
    user = known
    if user is None or user.only_watches:
        app.joins.spend(address, clock.monotonic_s())
        session_id, user = app.user_sessions.join(body.name or _NAMELESS, now_unix_s(), known)
        set_cookie(response, session_id)
    return app.user_sessions.host(user)


@router.delete("/rooms/{room}/host")
async def close_room_with_people(room: str, app: App, _host: HostingUser) -> Json:
    """Close a room, also where people sit, and send its name; 409 while an episode is recorded."""
    return {"room": await app.platform.close_room(room, with_people=True)}


@router.delete("/rooms/{room}/host/seats/{arm}")
async def free_seat(room: str, arm: str, app: App, host: HostingUser) -> Json:
    """Free anybody's seat and send it."""
    return {"seat": seat_json(await app.rooms.free_seat(room, arm, host), host.holder_id)}


@router.post("/rooms/{room}/host/episode")
async def end_episode(room: str, body: HostEpisodeRequest, app: App, host: HostingUser) -> Json:
    """End the episode for all, or practise anew, and send the room."""
    if body.action == "reset":
        await app.rooms.reset_for_all(room, host)
    else:
        await app.rooms.finish_for_all(room, host, _OUTCOMES[body.action])
    return _room_json(app, room, host)


@router.post("/rooms/{room}/host/pause")
async def pause(room: str, app: App, host: HostingUser) -> Json:
    """Pause the room, until a host lets it go on, and send it."""
    await app.rooms.pause(room, host)
    return _room_json(app, room, host)


@router.delete("/rooms/{room}/host/pause")
async def end_pause(room: str, app: App, host: HostingUser) -> Json:
    """Let the room go on, whoever paused or stopped it, and send it."""
    await app.rooms.end_pause(room, host)
    return _room_json(app, room, host)


@router.put("/rooms/{room}/host/plan")
async def set_plan(room: str, body: PlanRequest, app: App, host: HostingUser) -> Json:
    """Plan so many good episodes from now on, and send the room."""
    await app.rooms.set_plan(room, host, body.episodes)
    return _room_json(app, room, host)


@router.put("/rooms/{room}/host/course")
async def require_course(room: str, body: CourseRequest, app: App, host: HostingUser) -> Json:
    """Ask for the practice course before anybody records, or do so no more, and send the room."""
    await app.rooms.require_course(room, host, required=body.required)
    return _room_json(app, room, host)


def _require_host_code(app: AppState, given: str, address: str) -> None:
    try:
        check_host_code(given, app.host_code)
    except Forbidden:
        app.wrong_host_codes.count(address, clock.monotonic_s())
        raise


def _room_json(app: AppState, room: str, host: User) -> Json:
    return {"room": app.lobby.room_json(room, host.holder_id, clock.monotonic_s())}
