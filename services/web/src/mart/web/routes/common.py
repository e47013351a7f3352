"""What routes are given: the site, and the person who asks."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from mart.protocol import clock
from mart.web.errors import NotJoined
from mart.web.people import Person
from mart.web.site import Site

COOKIE = "__Host-mart-session"


def now_unix_s() -> float:
    return clock.wall_ns() / 1e9


async def site_of(connection: HTTPConnection) -> Site:
    site = connection.app.state.site
    assert isinstance(site, Site)
    return site


TheSite = Annotated[Site, Depends(site_of)]


async def visitor_of(connection: HTTPConnection, site: TheSite) -> Person | None:
    """Who asks, where they have joined."""
    session_id = connection.cookies.get(COOKIE)
    return site.people.find(session_id, now_unix_s()) if session_id else None


Visitor = Annotated[Person | None, Depends(visitor_of)]


async def person_of(visitor: Visitor) -> Person:
    """Who asks; raises NotJoined."""
    if visitor is None:
        raise NotJoined
    return visitor


async def address_of(connection: HTTPConnection) -> str:
    return connection.client.host if connection.client else "unknown"


Joined = Annotated[Person, Depends(person_of)]
Address = Annotated[str, Depends(address_of)]
