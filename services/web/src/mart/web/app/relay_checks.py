"""Ask the STUN and TURN servers now and then whether they do what they are there for."""

from __future__ import annotations

import asyncio

from mart.protocol.errors import Unavailable
from mart.runtime.ice_check import check_ice_server
from mart.runtime.ice_servers import IceServer, IceSettings
from mart.web.app.certificate_renewal import now
from mart.web.lobby.health_findings import RelayCheck

_CHECK_EVERY_S = 30.0


async def keep_checking(ice: IceSettings, found: dict[str, RelayCheck]) -> None:
    """Write into `found` what each server said last, by its URL, until cancelled."""
    while ice.ice_servers:
        servers = ice.ice_servers_at(now().timestamp())
        for server, check in zip(servers, await asyncio.gather(*map(_checked, servers)), strict=True):
            found[server.url] = check
        await asyncio.sleep(_CHECK_EVERY_S)


async def _checked(server: IceServer) -> RelayCheck:
    try:
        return RelayCheck(True, await check_ice_server(server))
    except Unavailable as error:
        return RelayCheck(False, str(error))
