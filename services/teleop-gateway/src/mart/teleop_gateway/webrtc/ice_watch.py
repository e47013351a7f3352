"""Know which STUN and TURN servers answer: connections use those alone, so that a silent one keeps nobody waiting.

aioice asks a server anew for each connection and waits 5 s for one that is silent, and every offer would wait with it.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Sequence

from mart.protocol import clock
from mart.protocol.errors import Unavailable
from mart.runtime.ice_check import check_ice_server
from mart.runtime.ice_servers import IceServer, IceSettings

_log = logging.getLogger(__name__)

_CHECK_EVERY_S = 30.0
_CHECK_TIMEOUT_S = 1.0


class IceWatch:
    """Ask the servers of `settings` now and then. `usable` is empty before the first `check`."""

    def __init__(self, settings: IceSettings) -> None:
        self._settings = settings
        self._answers: dict[str, bool] = {}

    def usable(self) -> Sequence[IceServer]:
        """Return the servers that answered last, with credentials that are good now."""
        servers = self._settings.ice_servers_at(clock.wall_ns() / 1e9)
        return [server for server in servers if self._answers.get(server.url, False)]

    async def check(self) -> None:
        """Ask all servers, at one time; log what has changed."""
        servers = self._settings.ice_servers_at(clock.wall_ns() / 1e9)
        await asyncio.gather(*(self._check(server) for server in servers))

    async def run(self) -> None:
        """Check every half minute, until cancelled."""
        while True:
            await asyncio.sleep(_CHECK_EVERY_S)
            await self.check()

    async def _check(self, server: IceServer) -> None:
        before = self._answers.get(server.url)
        try:
            found = await check_ice_server(server, _CHECK_TIMEOUT_S)
        except Unavailable as error:
            self._answers[server.url] = False
            if before is not False:
                _log.warning("%s Connections go without it meanwhile.", error)
        else:
            self._answers[server.url] = True
            if before is not True:
                _log.info("%s %s", server.url, found)
