"""The relays are asked in the background, with the credentials that pages get."""

from __future__ import annotations

import asyncio
import json

from mart.runtime.ice_servers import IceSettings
from mart.web.app.relay_checks import keep_checking
from mart.web.lobby.health_findings import RelayCheck
from tests.support.turn_server import turn_server


def test_what_each_says_is_known() -> None:
    async def check() -> None:
        async with turn_server("mart", "north") as (_, port):
            url = f"turn:127.0.0.1:{port}"
            for credential, ok in (("north", True), ("south", False)):
                entry = {"urls": url, "username": "mart", "credential": credential}
                found: dict[str, RelayCheck] = {}
                checking = asyncio.create_task(
                    keep_checking(IceSettings(ice_servers=json.dumps([entry])), found)
                )
                while url not in found:  # noqa: ASYNC110 - a dictionary has no event
                    await asyncio.sleep(0.01)
                assert found[url].ok is ok
                checking.cancel()

    asyncio.run(check())


def test_without_servers_nothing_is_asked() -> None:
    asyncio.run(keep_checking(IceSettings(), {}))
