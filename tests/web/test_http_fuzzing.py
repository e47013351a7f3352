"""The whole HTTP API from its own schema: whatever is sent is answered, in words where it is refused, and soon.

Minutes of it, by hand: `.venv/bin/pytest tests/web/test_http_fuzzing.py --hypothesis-profile fuzz`.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime as dt
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import httpx
import pytest
import schemathesis
from hypothesis import given
from hypothesis import strategies as st
from schemathesis import GenerationMode

from mart.protocol import clock, keys
from mart.protocol.tokens import Role, SeatToken, sign
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.serve import catalogue_answerer
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.web.access.certificate import ensure_certificate
from mart.web.access.request_limits import RequestLimit
from mart.web.access.user_sessions import UserSessions
from mart.web.api.app_state import AppState
from mart.web.app.application import create_app
from mart.web.lobby.bus_feed import LobbyFeed
from mart.web.lobby.lobby import Lobby
from tests.recorder.files import write_episode
from tests.support.fuzzing import fuzzing
from tests.web.conftest import HOST_CODE, JOIN_CODE, ORIGIN, site_called
from tests.web.room import Room
from tests.web.trainer import Trainer

SECRET = b"0123456789abcdef0123456789abcdef"
LONGEST_S = 10.0  # of an answer, on a machine that does much besides
_FAULT_OF_NOBODY = {503}  # a part that is not there


class NoSite:
    """Enough of a site to know its schema."""

    site = None


class Site:
    """The application with a room, a catalogue and a trainer behind it, on an event loop of its own."""

    def __init__(self, folder: Path) -> None:
        self._loop = asyncio.new_event_loop()
        self._opened = contextlib.ExitStack()
        bus = MemoryNetwork().connect()
        aio, lobby = AsyncBus(bus, self._loop), Lobby()
        self.app_state = AppState(
            bus=aio,
            lobby=lobby,
            user_sessions=self._opened.enter_context(contextlib.closing(UserSessions(":memory:"))),
            join_code=JOIN_CODE,
            host_code=HOST_CODE,
            secret=SECRET,
            site=site_called("localhost", lan_host="192.168.1.5"),
            data_dir=folder,
            certificate=ensure_certificate(folder, ["localhost"], dt.datetime.now(dt.UTC)).path,
            joins=RequestLimit("people who joined", count=10**9, window_s=1.0),
            writes=RequestLimit("changes", count=10**9, window_s=1.0),
        )
        write_episode(folder, ticks=3, number=1)
        catalogue = catalogue_answerer(CatalogueHandlers(folder))
        for opened in (
            LobbyFeed(aio, lobby),
            bus.serve(keys.catalogue("catalogue-1"), catalogue.respond),
            bus.announce(keys.alive(ServiceKind.CATALOGUE, "catalogue-1")),
            Trainer(bus),
            Room(bus),
        ):
            self._opened.enter_context(contextlib.closing(opened))
        self.app = create_app(self.app_state)
        self._client = self._loop.run_until_complete(self._joined())

    def close(self) -> None:
        self._loop.run_until_complete(self._client.aclose())
        self._opened.close()
        self._loop.run_until_complete(self._loop.shutdown_default_executor())
        self._loop.close()

    def send(self, **request: Any) -> httpx.Response:
        """The answer to a request of somebody who has joined."""
        answer = self._loop.run_until_complete(asyncio.wait_for(self._client.request(**request), LONGEST_S))
        has_left = request["method"] == "DELETE" and request["url"].endswith("/api/me")
        if answer.status_code == 401 or has_left:
            self._loop.run_until_complete(self._client.aclose())
            self._client = self._loop.run_until_complete(self._joined())
        return answer

    async def _joined(self) -> httpx.AsyncClient:
        transport = httpx.ASGITransport(self.app, raise_app_exceptions=False, client=("10.0.0.1", 50000))
        token = sign(SeatToken("room-1", "arm0", 0, Role.VIEWER, "ana", clock.wall_ns() / 1e9 + 600), SECRET)
        headers = {"Origin": ORIGIN, "Authorization": f"Bearer {token}"}
        client = httpx.AsyncClient(transport=transport, base_url=ORIGIN, headers=headers)
        joined = await client.post("/api/join", json={"code": JOIN_CODE, "name": "Ana"})
        assert joined.status_code == 200
        return client


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    with contextlib.closing(Site(tmp_path_factory.mktemp("site"))) as site:
        yield site


SCHEMA: Any = schemathesis.openapi.from_dict(create_app(cast("AppState", NoSite())).openapi())
OPERATIONS = {found.ok().label: found.ok() for found in SCHEMA.get_all_operations()}


def request_of(case: Any) -> dict[str, Any]:
    """What httpx is to send; who asks, and from which page, is the client's."""
    sent = case.as_transport_kwargs(base_url=ORIGIN)
    request = {name: sent[name] for name in ("method", "url", "params", "json") if name in sent}
    if isinstance(sent.get("data"), (str, bytes)):
        request["content"] = sent["data"]
    kind = sent["headers"].get("Content-Type")
    return request | ({"headers": {"Content-Type": kind}} if kind and "json" not in sent else {})


@pytest.mark.parametrize("label", OPERATIONS)
def test_whatever_is_sent_is_answered_in_words(site: Site, label: str) -> None:
    operation = OPERATIONS[label]
    either = st.one_of(*(operation.as_strategy(mode) for mode in GenerationMode))

    @fuzzing(examples=12)
    @given(case=either)
    def answered(case: Any) -> None:
        sent = request_of(case)
        answer = site.send(**sent)
        assert answer.status_code < 500 or answer.status_code in _FAULT_OF_NOBODY, (sent, answer.text)
        if answer.status_code >= 400:
            error = answer.json()["error"]
            assert error["code"], sent
            assert error["message"].endswith((".", "?")), (sent, error)
        assert answer.headers["x-content-type-options"] == "nosniff"

    answered()
