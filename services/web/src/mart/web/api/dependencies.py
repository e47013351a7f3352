"""What routes are given: what they share, and the user who asks."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from mart.protocol import clock
from mart.protocol.errors import Forbidden
from mart.web.access.join_code import check_join_code
from mart.web.access.user_sessions import User
from mart.web.api.app_state import AppState
from mart.web.errors import NotHost, NotJoined, OnlyWatches

COOKIE = "__Host-mart-session"


def now_unix_s() -> float:
    """Return the Unix time, seconds."""
    return clock.wall_ns() / 1e9


async def app_state_of(connection: HTTPConnection) -> AppState:
    """Return what all routes share."""
    app = connection.app.state.app_state
    assert isinstance(app, AppState)
    return app


App = Annotated[AppState, Depends(app_state_of)]


def session_of(connection: HTTPConnection) -> str:
    """Return the session's id that a request came with; empty where it came with none."""
    return connection.cookies.get(COOKIE, "")


async def maybe_user(connection: HTTPConnection, app: App) -> User | None:
    """Return who asks; None where they have not joined."""
    session_id = session_of(connection)
    return app.user_sessions.find(session_id, now_unix_s()) if session_id else None


MaybeUser = Annotated[User | None, Depends(maybe_user)]


async def watching_user(user: MaybeUser) -> User:
    """Return who asks, who may be a spectator; raises NotJoined."""
    if user is None:
        raise NotJoined
    return user


async def joined_user(user: Annotated[User, Depends(watching_user)]) -> User:
    """Return who asks; raises NotJoined, and OnlyWatches for a spectator."""
    if user.only_watches:
        raise OnlyWatches
    return user


async def hosting_user(user: Annotated[User, Depends(joined_user)]) -> User:
    """Return who asks, who gave the host code; raises NotJoined, OnlyWatches, and NotHost for a guest."""
    if not user.hosts:
        raise NotHost
    return user


async def browsing_user(user: Annotated[User, Depends(joined_user)], app: App) -> AsyncIterator[User]:
    """Yield who asks for what may take long; a few such requests of one person go on at a time, others wait."""
    async with app.browsing.turn(user.holder_id):
        yield user


async def fetching_user(user: Annotated[User, Depends(watching_user)], app: App) -> AsyncIterator[User]:
    """Yield who asks, who may be a spectator, for what may take long, as `browsing_user` does."""
    async with app.browsing.turn(user.holder_id):
        yield user


async def writing_user(user: Annotated[User, Depends(browsing_user)], app: App) -> User:
    """Return who asks for something to be kept or changed; raises TooMany where they do so too often."""
    app.writes.spend(user.holder_id, clock.monotonic_s())
    return user


async def address_of(connection: HTTPConnection) -> str:
    """Return the network address that a request comes from."""
    return connection.client.host if connection.client else "unknown"


def require_join_code(app: AppState, given: str, address: str, expected: str = "") -> None:
    """Raise Forbidden, and count it for `address`, where the join code, or the one `expected`, is not right."""
    try:
        check_join_code(given, expected or app.join_code)
    except Forbidden:
        app.wrong_codes.count(address, clock.monotonic_s())
        raise


WatchingUser = Annotated[User, Depends(watching_user)]
JoinedUser = Annotated[User, Depends(joined_user)]
HostingUser = Annotated[User, Depends(hosting_user)]
FetchingUser = Annotated[User, Depends(fetching_user)]
BrowsingUser = Annotated[User, Depends(browsing_user)]
WritingUser = Annotated[User, Depends(writing_user)]
Address = Annotated[str, Depends(address_of)]
