"""What a paired phone asks for besides driving: to stop everything, to let it go on, to begin or discard an episode."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Header
from pydantic import BaseModel

from mart.protocol import clock
from mart.protocol.holders import is_held_by
from mart.protocol.messages import OUTCOME_DISCARDED
from mart.web.access.user_sessions import User
from mart.web.api.app_state import AppState
from mart.web.api.dependencies import App
from mart.web.api.signaling import claims_of
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api/rooms/{room}/seats/{arm}")

Authorization = Annotated[str, Header()]


class PhoneActionRequest(BaseModel):
    """What shall happen with the episode, in the name of whoever paired the phone."""

    action: Literal["ready", "unready", "discard"]


@router.post("/stop")
async def stop(room: str, arm: str, app: App, authorization: Authorization = "") -> Json:
    """Stop everything in the room of a phone, until somebody lets go; send its name."""
    person = _person(app, room, arm, authorization)
    await app.rooms.stop(room, person.holder_id, person.name)
    return {"room": room}


@router.delete("/stop")
async def let_go_of_stop(room: str, arm: str, app: App, authorization: Authorization = "") -> Json:
    """Let everything go on in the room of a phone, whoever stopped it; send its name."""
    await app.rooms.let_go_of_stop(room, _person(app, room, arm, authorization).name)
    return {"room": room}


@router.post("/episode")
async def act(
    room: str, arm: str, body: PhoneActionRequest, app: App, authorization: Authorization = ""
) -> Json:
    """Do what is wanted with the episode; send the room's name."""
    person = _person(app, room, arm, authorization)
    if body.action == "discard":
        await app.rooms.finish_episode(room, person, OUTCOME_DISCARDED)
    else:
        await app.rooms.set_ready(room, arm, person, body.action == "ready")
    return {"room": room}


@router.post("/phone-switch")
async def switch(room: str, arm: str, app: App, authorization: Authorization = "") -> Json:
    """Give whoever paired the phone the next arm that no other person drives instead of this one; send its name.

    A renewed token of the phone is for that arm.
    """
    taken = await app.switch_seat(room, arm, _person(app, room, arm, authorization))
    return {"arm": taken.arm}


def _person(app: AppState, room: str, arm: str, authorization: str) -> User:
    """Return who paired the phone, by the name that the room knows them by. Raises what `claims_of` raises."""
    paired = claims_of(app, room, arm, authorization)
    seat = app.lobby.rooms.seat(room, arm, clock.monotonic_s())
    named = is_held_by(seat, paired.holder_id) and seat.name
    passed = app.user_sessions.has_passed_course(paired.holder_id)
    return User(paired.holder_id, seat.name if named else "A phone", passed_course=passed)
