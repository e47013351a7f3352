"""What all clients of a service share: which one of its kind is asked, and what is said where none runs."""

from __future__ import annotations

from typing import ClassVar

from mart.protocol.errors import Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.web.clients.running_services import running_ids
from mart.web.lobby.lobby import Lobby


class ServiceClient:
    """Requests to the first service of one kind that is alive."""

    kind: ClassVar[ServiceKind]
    absence: ClassVar[str]  # one sentence for where none runs

    def __init__(self, bus: AsyncBus, lobby: Lobby) -> None:
        self._bus, self._lobby = bus, lobby

    @property
    def is_running(self) -> bool:
        """Whether a service of this kind is alive."""
        return bool(self._lobby.services.ids(self.kind))

    async def _running_id(self) -> str:
        running = await running_ids(self._lobby, self.kind)
        if not running:
            raise Unavailable(self.absence)
        return running[0]
