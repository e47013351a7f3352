"""The rooms as they change, pushed to the pages."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, WebSocket

from mart.protocol import clock
from mart.web.access.user_sessions import User
from mart.web.api.dependencies import App, MaybeUser
from mart.web.lobby.listeners import LobbyListener
from mart.web.lobby.lobby import Lobby

router = APIRouter(prefix="/api")

_SHORTEST_PERIOD_S = 0.1
_LONGEST_PERIOD_S = 1.0

After = Annotated[int | None, Query(ge=0, lt=2**63)]


@router.websocket("/live")
async def live(socket: WebSocket, app: App, user: MaybeUser, after: After = None) -> None:
    """Push rooms and events; a page that comes back is told first what came after the event that it heard last."""
    if user is None:
        await socket.close(reason="Join in the lobby first.")
        return
    await socket.accept()
    with app.lobby.listeners.listen(after) as listener:
        telling = asyncio.ensure_future(_tell(socket, app.lobby, listener, user))
        leaving = asyncio.ensure_future(_left(socket))
        await asyncio.wait({telling, leaving}, return_when=asyncio.FIRST_COMPLETED)
        for task in (telling, leaving):
            task.cancel()
        await asyncio.gather(telling, leaving, return_exceptions=True)


async def _tell(socket: WebSocket, lobby: Lobby, listener: LobbyListener, user: User) -> None:
    while True:
        await socket.send_json({"rooms": lobby.rooms_json(user.holder_id, clock.monotonic_s())})
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
