"""The rooms as they change, pushed to the pages."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, WebSocket

from mart.protocol import clock
from mart.web.access.user_sessions import User
from mart.web.api.app_state import AppState
from mart.web.api.dependencies import App, MaybeUser, now_unix_s, session_of
from mart.web.errors import TooMany
from mart.web.lobby.listeners import LobbyListener

router = APIRouter(prefix="/api")

_SHORTEST_PERIOD_S = 0.1
_LONGEST_PERIOD_S = 1.0
CHECK_EVERY_S = 5.0  # whether the visit goes on

After = Annotated[int | None, Query(ge=0, lt=2**63)]


@router.websocket("/live")
async def live(socket: WebSocket, app: App, user: MaybeUser, after: After = None) -> None:
    """Push rooms and events; a page that comes back is told first what came after the event that it heard last."""
    if user is None:
        await socket.close(reason="Join in the lobby first.")
        return
    try:
        with app.live_sockets.hold(user.holder_id):
            await _push(socket, app, user, after)
    except TooMany as error:
        await socket.close(reason=str(error))


async def _push(socket: WebSocket, app: AppState, user: User, after: int | None) -> None:
    await socket.accept()
    with app.lobby.listeners.listen(after) as listener:
        telling = asyncio.ensure_future(_tell(socket, app, listener, user))
        leaving = asyncio.ensure_future(_left(socket))
        await asyncio.wait({telling, leaving}, return_when=asyncio.FIRST_COMPLETED)
        for task in (telling, leaving):
            task.cancel()
        await asyncio.gather(telling, leaving, return_exceptions=True)


async def _tell(socket: WebSocket, app: AppState, listener: LobbyListener, user: User) -> None:
    """Tell until the visit ends."""
    session_id = session_of(socket)
    look_again_s = clock.monotonic_s() + CHECK_EVERY_S
    while True:
        now_s = clock.monotonic_s()
        if now_s >= look_again_s:
            look_again_s = now_s + CHECK_EVERY_S
            if app.user_sessions.find(session_id, now_unix_s()) is None:
                await socket.close(reason="Your visit has ended; join in the lobby again.")
                return
        await socket.send_text(app.rooms_text.text(user.holder_id, now_s))
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
