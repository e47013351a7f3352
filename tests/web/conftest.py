"""The web application on an in-memory bus, with a room behind it; and people with a session each."""

from __future__ import annotations

import asyncio
import contextlib
import datetime as dt
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path

import httpx
import pytest

from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from mart.web.access.certificate import ensure_certificate
from mart.web.access.site_names import SiteNames
from mart.web.access.user_sessions import UserSessions
from mart.web.api.app_state import AppState
from mart.web.app.application import create_app
from mart.web.lobby.bus_feed import LobbyFeed
from mart.web.lobby.lobby import Lobby
from tests.web.room import Room

JOIN_CODE = "ABCD-2345"
HOST_CODE = "HHHH-2345-6789"
ORIGIN = "https://localhost"

Client = httpx.AsyncClient
Enter = Callable[..., Awaitable[Client]]


def site_called(*names: str, lan_host: str) -> SiteNames:
    """A site that is called so, on whatever machine."""
    site = SiteNames(names, "127.0.0.1")
    site.names, site.lan_host = names, lan_host
    return site


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def bus() -> MemoryBus:
    return MemoryNetwork().connect()


@pytest.fixture
async def app_state(bus: MemoryBus, tmp_path: Path) -> AsyncIterator[AppState]:
    aio = AsyncBus(bus, asyncio.get_running_loop())
    with contextlib.closing(UserSessions(":memory:")) as user_sessions, contextlib.ExitStack() as opened:
        lobby = Lobby(user_sessions.pass_course)
        opened.enter_context(contextlib.closing(LobbyFeed(aio, lobby)))
        yield AppState(
            bus=aio,
            lobby=lobby,
            user_sessions=user_sessions,
            join_code=JOIN_CODE,
            host_code=HOST_CODE,
            secret=b"0123456789abcdef0123456789abcdef",
            site=site_called("localhost", "lab.example", lan_host="192.168.1.5"),
            data_dir=tmp_path,
            certificate=ensure_certificate(tmp_path, ["localhost"], dt.datetime.now(dt.UTC)).path,
        )


@pytest.fixture
async def room(app_state: AppState, bus: MemoryBus) -> AsyncIterator[Room]:
    with contextlib.closing(Room(bus)) as room:
        await asyncio.sleep(0)  # what the room said at its opening is on its way to the site
        yield room


@pytest.fixture
async def enter(app_state: AppState) -> AsyncIterator[Enter]:
    """`await enter("Ana")` is a browser that has joined; `await enter()` one that has not."""
    app = create_app(app_state)
    async with contextlib.AsyncExitStack() as clients:

        async def make(name: str = "", address: str = "10.0.0.1") -> Client:
            transport = httpx.ASGITransport(app, raise_app_exceptions=False, client=(address, 50000))
            client = Client(transport=transport, base_url=ORIGIN, headers={"Origin": ORIGIN})
            await clients.enter_async_context(client)
            if name:
                joined = await client.post("/api/join", json={"code": JOIN_CODE, "name": name})
                assert joined.status_code == 200
            return client

        yield make
