"""The catalogue of recorded episodes on the bus: what people ask becomes a query, its answer JSON for the pages."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol import codec, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import CatalogueReply, CatalogueRequest, raise_error
from mart.runtime.bus.aio import AsyncBus

_TIMEOUT_S = 20.0  # a folder of many episodes is read when it is first asked for
_MAX_REPLY_BYTES = 16 * 1024 * 1024


class CatalogueClient:
    """`running` gives the ids of the catalogues that are alive."""

    def __init__(self, bus: AsyncBus, running: Callable[[], list[str]]) -> None:
        self._bus, self._running = bus, running

    @property
    def is_running(self) -> bool:
        return bool(self._running())

    async def ask(self, request: CatalogueRequest) -> CatalogueReply:
        """Raises Unavailable where no catalogue runs, and what the catalogue reports."""
        running = self._running()
        if not running:
            raise Unavailable("Nothing tells about recorded episodes; start it with `mart catalogue`.")
        payload = await self._bus.query(keys.catalogue(running[0]), codec.encode(request), _TIMEOUT_S)
        reply = codec.decode(CatalogueReply, payload, _MAX_REPLY_BYTES)
        raise_error(reply.error)
        return reply
