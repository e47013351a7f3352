"""Joining with the code, and who one is."""

from __future__ import annotations

from fastapi import APIRouter, Response
from pydantic import BaseModel

from mart.protocol import clock
from mart.protocol.errors import Forbidden
from mart.web.access.join_code import check_join_code
from mart.web.access.user_sessions import SESSION_S, User
from mart.web.api.dependencies import COOKIE, Address, App, JoinedUser, MaybeUser, now_unix_s

router = APIRouter(prefix="/api")


class JoinRequest(BaseModel):
    """A join code and the name under which others shall see one."""

    code: str
    name: str


@router.post("/join")
async def join(body: JoinRequest, response: Response, app: App, known: MaybeUser, address: Address) -> User:
    """Let in whoever gives the join code, and set the session's cookie; five wrong codes a minute from one address."""
    now_s = clock.monotonic_s()
    app.wrong_codes.check(address, now_s)
    try:
        check_join_code(body.code, app.join_code)
    except Forbidden:
        app.wrong_codes.count(address, now_s)
        raise
    app.wrong_codes.forgive(address)
    session_id, user = app.user_sessions.join(body.name, now_unix_s(), known)
    response.set_cookie(
        COOKIE, session_id, max_age=int(SESSION_S), path="/", secure=True, httponly=True, samesite="strict"
    )
    return user


@router.get("/me")
async def me(user: JoinedUser) -> User:
    """Tell who one is."""
    return user
