"""Named data sets: episodes are put into one or taken out, and any such act is undone."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter
from pydantic import BaseModel, Field

from mart.protocol.messages import CatalogueRequest
from mart.web.lobby import Json
from mart.web.routes.common import Joined, TheSite
from mart.web.routes.episodes import Filter
from mart.web.trainer import as_json

router = APIRouter(prefix="/api/datasets")


class Curation(BaseModel):
    """Which episodes: those of `paths`, or `all` that a filter lets through."""

    action: Literal["add", "remove"]
    paths: list[Annotated[str, Field(max_length=1024)]] = Field(default_factory=list, max_length=200)
    all: Filter | None = None

    def request(self, dataset: str) -> CatalogueRequest:
        curate = CatalogueRequest.Curate(dataset=dataset, take_out=self.action == "remove", paths=self.paths)
        if self.all is not None:
            curate.all.CopyFrom(CatalogueRequest.List(**self.all.model_dump()))
        return CatalogueRequest(curate=curate)


class Undoing(BaseModel):
    act_ns: int = Field(ge=0, lt=2**64)


@router.post("/{dataset}")
async def curate(dataset: str, body: Curation, site: TheSite, _person: Joined) -> Json:
    return {"curated": as_json((await site.catalogue.ask(body.request(dataset))).curated)}


@router.post("/{dataset}/undo")
async def undo(dataset: str, body: Undoing, site: TheSite, _person: Joined) -> Json:
    request = CatalogueRequest(undo=CatalogueRequest.Undo(dataset=dataset, act_ns=body.act_ns))
    return {"curated": as_json((await site.catalogue.ask(request)).curated)}
