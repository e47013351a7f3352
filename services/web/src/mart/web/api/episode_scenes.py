"""What a page needs to draw a recorded episode: which scene it is of, and where its bodies are in every tick."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from starlette.responses import Response, StreamingResponse

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import CatalogueReply, CatalogueRequest
from mart.web.api.app_state import AppState
from mart.web.api.dependencies import App, BrowsingUser
from mart.web.api.texts import FilePath
from mart.web.clients.pieces import pieces_of
from mart.web.clients.scene_store import MAX_STORED_BYTES
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api/episode")

Path = Annotated[FilePath, Query()]


@router.get("/scene")
async def scene(path: Path, app: App, _user: BrowsingUser) -> Json:
    """Send the digest of the scene that an episode was recorded in; from then on it can be had."""
    known = tuple(app.scenes.known())

    async def piece(offset: int) -> CatalogueReply.Piece:
        asked = CatalogueRequest.Scene(path=path, offset=offset, known_sha256=known)
        return await _piece(app, CatalogueRequest(scene=asked))

    first = await piece(0)
    if first.piece:
        if first.size_bytes > MAX_STORED_BYTES:
            raise InvalidInput("This episode's scene is too large to be drawn in a page; draw it as a video.")
        app.scenes.put(first.sha256, b"".join([part async for part in pieces_of(first, piece)]))
    return {"sha256": first.sha256}


@router.get("/motion")
async def motion(path: Path, app: App, _user: BrowsingUser, simulated: bool = False) -> Response:
    """Send where the bodies are in every tick (docs/protocol.md, "Motion")."""

    async def piece(offset: int) -> CatalogueReply.Piece:
        asked = CatalogueRequest.Motion(path=path, offset=offset, simulated=simulated)
        return await _piece(app, CatalogueRequest(motion=asked))

    first = await piece(0)
    return StreamingResponse(
        pieces_of(first, piece),
        media_type="application/octet-stream",
        headers={"Content-Length": str(first.size_bytes)},
    )


async def _piece(app: AppState, request: CatalogueRequest) -> CatalogueReply.Piece:
    return (await app.catalogue.ask(request)).piece
