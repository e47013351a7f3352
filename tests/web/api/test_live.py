"""The live socket without a network: what the application sends to a page."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, MutableMapping
from typing import Any

import pytest

from mart.web.api import live
from mart.web.api.app_state import AppState
from mart.web.app.application import create_app
from tests.web.conftest import Client, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

Message = MutableMapping[str, Any]


class Page:
    """One end of a live socket."""

    def __init__(self) -> None:
        self.sent: asyncio.Queue[Message] = asyncio.Queue()
        self.said: asyncio.Queue[Message] = asyncio.Queue()

    async def next(self) -> Message:
        return await asyncio.wait_for(self.sent.get(), 30)

    async def next_of(self, kind: str) -> Message:
        while (message := await self.next())["type"] != kind:
            pass
        return message


@contextlib.asynccontextmanager
async def opened(app_state: AppState, client: Client) -> AsyncIterator[Page]:
    page = Page()
    cookie = "; ".join(f"{one.name}={one.value}" for one in client.cookies.jar)
    headers = {"host": "localhost", "origin": "https://localhost", "cookie": cookie}
    scope = {
        "type": "websocket",
        "path": "/api/live",
        "query_string": b"",
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
        "client": ("10.0.0.1", 50000),
        "subprotocols": [],
    }
    page.said.put_nowait({"type": "websocket.connect"})
    running = asyncio.ensure_future(create_app(app_state)(scope, page.said.get, page.sent.put))
    try:
        yield page
    finally:
        page.said.put_nowait({"type": "websocket.disconnect", "code": 1000})
        await asyncio.wait_for(running, 30)


async def test_a_visit_that_ends_ends_its_live_socket(
    app_state: AppState, enter: Enter, room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "CHECK_EVERY_S", 0.05)
    ana = await enter("Ana")
    async with opened(app_state, ana) as page:
        told = await page.next_of("websocket.send")
        assert json.loads(told["text"])["rooms"][0]["room"] == room.name
        await ana.delete("/api/me")
        assert "ended" in (await page.next_of("websocket.close"))["reason"]


async def test_a_person_has_so_many_live_sockets_and_others_have_theirs(
    app_state: AppState, enter: Enter
) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    async with contextlib.AsyncExitStack() as pages:
        for _ in range(16):
            page = await pages.enter_async_context(opened(app_state, ana))
            assert (await page.next())["type"] == "websocket.accept"
        refused = await pages.enter_async_context(opened(app_state, ana))
        assert (await refused.next())["type"] == "websocket.close"
        other = await pages.enter_async_context(opened(app_state, ben))
        assert (await other.next())["type"] == "websocket.accept"
    async with opened(app_state, ana) as page:
        assert (await page.next())["type"] == "websocket.accept"


async def test_a_stranger_has_none(app_state: AppState, enter: Enter) -> None:
    async with opened(app_state, await enter()) as page:
        assert (await page.next())["type"] == "websocket.close"
