"""How well episodes were recorded and driven: of one, and people and days beside each other."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query

from mart.protocol.messages import CatalogueRequest
from mart.web.api.dependencies import App, BrowsingUser
from mart.web.api.episodes import Path, episode_json
from mart.web.api.texts import Word
from mart.web.clients.message_json import as_json
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api")


@router.get("/episode/quality")
async def episode_quality(path: Path, app: App, _user: BrowsingUser) -> Json:
    """Send how well one episode was; `pending` while it is not measured yet."""
    request = CatalogueRequest(show_quality=CatalogueRequest.ShowQuality(path=path))
    return {"quality": as_json((await app.catalogue.ask(request)).quality_details)}


@router.get("/episodes/quality")
async def compared_quality(
    task: Annotated[Word, Query()],
    app: App,
    _user: BrowsingUser,
    by: Literal["operator", "day"] = "operator",
) -> Json:
    """Send how well the episodes of a task were, by operator or by day."""
    request = CatalogueRequest(compare_quality=CatalogueRequest.CompareQuality(task=task, by=by))
    found = (await app.catalogue.ask(request)).quality_comparison
    return {"comparison": as_json(found) | {"outliers": [episode_json(one) for one in found.outliers]}}
