"""Joining with the code, and who one is."""

from __future__ import annotations

from fastapi import APIRouter, Response
from pydantic import BaseModel

from mart.protocol import clock
from mart.protocol.errors import Forbidden
from mart.web.join_code import check_join_code
from mart.web.people import SESSION_S, Person
from mart.web.routes.common import COOKIE, Address, Joined, TheSite, Visitor, now_unix_s

router = APIRouter(prefix="/api")


class Join(BaseModel):
    code: str
    name: str


@router.post("/join")
async def join(body: Join, response: Response, site: TheSite, visitor: Visitor, address: Address) -> Person:
    now_s = clock.monotonic_s()
    site.wrong_codes.check(address, now_s)
    try:
        check_join_code(body.code, site.join_code)
    except Forbidden:
        site.wrong_codes.count(address, now_s)
        raise
    site.wrong_codes.forgive(address)
    session_id, person = site.people.join(body.name, now_unix_s(), visitor)
    response.set_cookie(
        COOKIE, session_id, max_age=int(SESSION_S), path="/", secure=True, httponly=True, samesite="strict"
    )
    return person


@router.get("/me")
async def me(person: Joined) -> Person:
    return person
