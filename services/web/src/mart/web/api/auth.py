"""Joining with the code, and who one is."""

from __future__ import annotations

import asyncio
import contextlib

from fastapi import APIRouter, Response
from pydantic import BaseModel

from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.web.access.join_code import watch_code_of
from mart.web.access.user_sessions import SESSION_S, User
from mart.web.api.dependencies import (
    COOKIE,
    Address,
    App,
    MaybeUser,
    WatchingUser,
    now_unix_s,
    require_join_code,
)

router = APIRouter(prefix="/api")


class JoinRequest(BaseModel):
    """A join code and the name under which others shall see one."""

    code: str
    name: str


class WatchRequest(BaseModel):
    """The code of a link for spectators."""

    code: str


@router.post("/join")
async def join(body: JoinRequest, response: Response, app: App, known: MaybeUser, address: Address) -> User:
    """Let in whoever gives the join code, and set the session's cookie.

    After five wrong codes from an address the answers to it take longer, also that to the right code; nobody waits
    who has joined already.
    """
    if known is None:
        await asyncio.sleep(app.wrong_codes.delay_s(address, clock.monotonic_s()))
    require_join_code(app, body.code, address)
    if known is None:
        app.joins.spend(address, clock.monotonic_s())
    session_id, user = app.user_sessions.join(body.name, now_unix_s(), known)
    set_cookie(response, session_id)
    return user


@router.post("/watch")
async def watch(body: WatchRequest, response: Response, app: App, known: MaybeUser, address: Address) -> User:
    """Let a spectator in by the code of the link, which lets nobody drive; whoever has joined stays who they are."""
    if known is not None:
        return known
    await asyncio.sleep(app.wrong_codes.delay_s(address, clock.monotonic_s()))
    require_join_code(app, body.code, address, watch_code_of(app.join_code, app.secret))
    app.joins.spend(address, clock.monotonic_s())
    session_id, user = app.user_sessions.join("Spectator", now_unix_s(), only_watches=True)
    set_cookie(response, session_id)
    return user


@router.get("/me")
async def me(user: WatchingUser) -> User:
    """Tell who one is."""
    return user


@router.delete("/me")
async def leave(response: Response, app: App, user: WatchingUser) -> User:
    """End one's visit: the session is forgotten, one's seats are free. Tell who one was."""
    for room, arm in app.lobby.rooms.seats_of(user.holder_id, clock.monotonic_s()):
        with contextlib.suppress(MartError):  # a room that does not answer frees the seat when it is claimed
            await app.rooms.leave_seat(room, arm, user)
    app.user_sessions.leave(user)
    response.delete_cookie(COOKIE, path="/", secure=True, httponly=True, samesite="strict")
    return user


def set_cookie(response: Response, session_id: str) -> None:
    """Have the browser keep a session, where no script reads it."""
    response.set_cookie(
        COOKIE, session_id, max_age=int(SESSION_S), path="/", secure=True, httponly=True, samesite="strict"
    )
