"""Scenes, for pages that draw a room by themselves: which one a seat has, and each by its digest, for ever."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path
from starlette.responses import Response

from mart.protocol import clock
from mart.web.api.dependencies import App, FetchingUser
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api")

Digest = Annotated[str, Path(pattern="^[0-9a-f]{64}$")]


@router.get("/rooms/{room}/seats/{arm}/scene")
async def scene(room: str, arm: str, app: App, _user: FetchingUser) -> Json:
    """Send the digest of the scene that a seat's picture shows; from then on it can be had."""
    app.lobby.rooms.seat(room, arm, clock.monotonic_s())
    reply = await app.gateways.scene(room, arm, app.scenes.known())
    if reply.scene_gzip:
        app.scenes.put(reply.sha256, reply.scene_gzip)
    return {"sha256": reply.sha256}


@router.get("/scenes/{sha256}")
async def scene_file(sha256: Digest, app: App, _user: FetchingUser) -> Response:
    """Send a scene. Its name is its digest, so nobody has to ask for it twice."""
    return Response(
        app.scenes.get(sha256), media_type="application/octet-stream", headers={"Content-Encoding": "gzip"}
    )
