from __future__ import annotations

import asyncio

import pytest

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.web.clients import running_services
from mart.web.clients.running_services import running_ids
from mart.web.lobby.lobby import Lobby

pytestmark = pytest.mark.anyio

GATEWAY = keys.alive(ServiceKind.GATEWAY, "gateway-1")


async def test_who_was_there_is_awaited_and_who_never_was_is_not() -> None:
    lobby = Lobby()
    assert await running_ids(lobby, ServiceKind.GATEWAY) == []
    lobby.see_alive(GATEWAY, True)
    assert await running_ids(lobby, ServiceKind.GATEWAY) == ["gateway-1"]
    lobby.see_alive(GATEWAY, False)
    asked = asyncio.create_task(running_ids(lobby, ServiceKind.GATEWAY))
    await asyncio.sleep(0)
    assert not asked.done()
    lobby.see_alive(GATEWAY, True)
    assert await asked == ["gateway-1"]


async def test_who_stays_away_is_not_awaited_for_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running_services, "AWAY_S", 0.01)
    lobby = Lobby()
    for alive in (True, False):
        lobby.see_alive(GATEWAY, alive)
    assert await running_ids(lobby, ServiceKind.GATEWAY) == []
