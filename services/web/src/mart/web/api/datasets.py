"""Named data sets: episodes are put into one or taken out, and any such act is undone."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel, Field

from mart.protocol.messages import CatalogueRequest
from mart.web.api.dependencies import App, WritingUser
from mart.web.api.episodes import CatalogueFilter
from mart.web.api.texts import FilePath
from mart.web.clients.message_json import as_json
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api/datasets")


class DatasetEditRequest(BaseModel):
    """Which episodes join or leave a data set: those of `paths`, or `all` that a filter lets through."""

    action: Literal["add", "remove"]
    paths: list[FilePath] = Field(default_factory=list, max_length=200)
    all: CatalogueFilter | None = None

    def request(self, dataset: str, by: str) -> CatalogueRequest:
        """Return the catalogue's request for the data set `dataset`, said by somebody of that name."""
        curate = CatalogueRequest.Curate(
            dataset=dataset, take_out=self.action == "remove", paths=self.paths, by=by
        )
        if self.all is not None:
            curate.all.CopyFrom(CatalogueRequest.List(**self.all.model_dump()))
        return CatalogueRequest(curate=curate)


class UndoRequest(BaseModel):
    """The act that is undone, by its stamp."""

    act_ns: int = Field(ge=0, lt=2**64)


@router.post("/{dataset}")
async def curate(dataset: str, body: DatasetEditRequest, app: App, user: WritingUser) -> Json:
    """Put episodes into a data set, or take them out."""
    return {"curated": as_json((await app.catalogue.ask(body.request(dataset, user.name))).curated)}


@router.post("/{dataset}/undo")
async def undo(dataset: str, body: UndoRequest, app: App, user: WritingUser) -> Json:
    """Undo an act of `curate`."""
    request = CatalogueRequest(undo=CatalogueRequest.Undo(dataset=dataset, act_ns=body.act_ns, by=user.name))
    return {"curated": as_json((await app.catalogue.ask(request)).curated)}
