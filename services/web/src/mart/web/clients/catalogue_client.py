"""Recorded episodes, asked of the catalogue that runs beside the recorder."""

from __future__ import annotations

from mart.protocol import keys
from mart.protocol.messages import CatalogueReply, CatalogueRequest
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.ask import ask_async
from mart.web.clients.service_client import ServiceClient

_TIMEOUT_S = 20.0  # a folder of many episodes is read when it is first asked for
_MAX_REPLY_BYTES = 16 * 1024 * 1024


class CatalogueClient(ServiceClient):
    """Requests to the catalogue of episodes."""

    kind = ServiceKind.CATALOGUE
    absence = "Nothing tells about recorded episodes; start it with `mart catalogue`."

    async def ask(self, request: CatalogueRequest) -> CatalogueReply:
        """Return the catalogue's answer; raises Unavailable where none runs, and what the catalogue reports."""
        return await ask_async(
            self._bus,
            keys.catalogue(await self._running_id()),
            request,
            CatalogueReply,
            timeout_s=_TIMEOUT_S,
            limit_bytes=_MAX_REPLY_BYTES,
        )
