"""Answer who tries the way to this gateway, in the gateway's own process; WebRTC is loaded there when somebody does."""

from __future__ import annotations

import asyncio
import importlib
from typing import TYPE_CHECKING

from mart.protocol.messages import Answer, Offer
from mart.protocol.queryables import CONNECTION_CHECK
from mart.runtime.ice_servers import IceSettings
from mart.runtime.serving import AsyncRequestAnswerer

if TYPE_CHECKING:
    from mart.teleop_gateway.webrtc.connection_check import ConnectionChecks

_MODULE = "mart.teleop_gateway.webrtc.connection_check"  # 40 MB that most gateways never need


class CheckHandler:
    """Reply to an Offer with the Answer of a connection that sends back what it gets, or with the error."""

    def __init__(self, settings: IceSettings) -> None:
        """Use the STUN and TURN servers of `settings`."""
        self._settings = settings
        self._checks: ConnectionChecks | None = None
        self.answer = AsyncRequestAnswerer(CONNECTION_CHECK, self._answer)

    async def close(self) -> None:
        """Return when all connections have ended."""
        if self._checks is not None:
            await self._checks.close()

    async def _answer(self, offer: Offer) -> Answer:
        if self._checks is None:
            await asyncio.to_thread(importlib.import_module, _MODULE)
        return await self._loaded().answer(offer)

    def _loaded(self) -> ConnectionChecks:
        if self._checks is None:
            self._checks = importlib.import_module(_MODULE).ConnectionChecks(self._settings)
        return self._checks
