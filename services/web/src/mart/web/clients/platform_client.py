"""Opening and closing rooms, asked of the platform that runs them on this machine."""

from __future__ import annotations

from mart.protocol import keys
from mart.protocol.messages import RoomReply, RoomsRequest
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.ask import ask_async
from mart.web.clients.service_client import ServiceClient

_TIMEOUT_S = 45.0  # a sim that is stopped may take its time


class PlatformClient(ServiceClient):
    """Requests to the platform; each raises Unavailable where none runs, and what the platform reports."""

    kind = ServiceKind.PLATFORM
    absence = "Nothing here opens or closes rooms; where each part is started by hand, start a `mart sim`."

    async def open_room(self, wanted: RoomsRequest.Open) -> str:
        """Open a room and return its name; its sim comes up within seconds."""
        return await self._ask(RoomsRequest(open=wanted))

    async def close_room(self, room: str, *, with_people: bool = False) -> str:
        """Close a room and return its name; one in which humans sit only `with_people`."""
        return await self._ask(RoomsRequest(close=RoomsRequest.Close(room=room, with_people=with_people)))

    async def _ask(self, request: RoomsRequest) -> str:
        topic = keys.rooms(await self._running_id())
        reply = await ask_async(self._bus, topic, request, RoomReply, timeout_s=_TIMEOUT_S)
        return reply.status.room
