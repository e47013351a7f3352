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


def site_of(connection: HTTPConnection) -> Site:
    site = connection.app.state.site
    assert isinstance(site, Site)
    return site


def visitor_of(connection: HTTPConnection) -> Person | None:
    """Who asks, where they have joined."""
    session_id = connection.cookies.get(COOKIE)
    return site_of(connection).people.find(session_id, now_unix_s()) if session_id else None


def person_of(connection: HTTPConnection) -> Person:
    """Who asks; raises NotJoined."""
    person = visitor_of(connection)
    if person is None:
        raise NotJoined
    return person


def address_of(connection: HTTPConnection) -> str:
    return connection.client.host if connection.client else "unknown"


TheSite = Annotated[Site, Depends(site_of)]
Joined = Annotated[Person, Depends(person_of)]
Visitor = Annotated[Person | None, Depends(visitor_of)]
Address = Annotated[str, Depends(address_of)]
