"""The rooms as they change, pushed to the pages."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter, WebSocket

from mart.protocol import clock
from mart.web.people import Person
from mart.web.rooms import Listener, Rooms
from mart.web.routes.common import TheSite, Visitor

router = APIRouter(prefix="/api")

_SHORTEST_PERIOD_S = 0.1
_LONGEST_PERIOD_S = 1.0


@router.websocket("/live")
async def live(socket: WebSocket, site: TheSite, visitor: Visitor) -> None:
    if visitor is None:
        await socket.close(reason="Join in the lobby first.")
        return
    await socket.accept()
    with site.rooms.listen() as listener:
        telling = asyncio.ensure_future(_tell(socket, site.rooms, listener, visitor))
        leaving = asyncio.ensure_future(_left(socket))
        await asyncio.wait({telling, leaving}, return_when=asyncio.FIRST_COMPLETED)
        for task in (telling, leaving):
            task.cancel()
        await asyncio.gather(telling, leaving, return_exceptions=True)


async def _tell(socket: WebSocket, rooms: Rooms, listener: Listener, person: Person) -> None:
    while True:
        await socket.send_json({"rooms": rooms.lobby.rooms_json(person.holder_id, clock.monotonic_s())})
        for event in listener.take_events():
            await socket.send_json({"event": event})
        await asyncio.sleep(_SHORTEST_PERIOD_S)
        await listener.wait(_LONGEST_PERIOD_S - _SHORTEST_PERIOD_S)


async def _left(socket: WebSocket) -> None:
    """Pages send nothing here: whatever arrives is dropped until they leave."""
    while True:
        message = await socket.receive()
        if message["type"] == "websocket.disconnect":
            return
