"""How everything does: for machines in one word, for people with what to do."""

from __future__ import annotations

import shutil
from dataclasses import asdict

from fastapi import APIRouter

from mart.protocol import clock
from mart.web.certificate import days_left
from mart.web.health import delays, machine, rooms, services
from mart.web.lobby import Json
from mart.web.routes.common import Joined, TheSite, now_unix_s

router = APIRouter(prefix="/api/health")

_EXPECTED = ("sim", "gateway", "recorder")


@router.get("")
async def health(site: TheSite) -> Json:
    """`ok`: everything that a collection session needs is there."""
    running = site.rooms.services()
    return {"ok": all(kind in running for kind in _EXPECTED), "services": running}


@router.get("/findings")
async def findings(site: TheSite, _person: Joined) -> Json:
    """Everything that is known, each problem with its mend."""
    known = (
        *services(site.rooms.services()),
        *rooms(site.rooms.lobby.rooms_json("", clock.monotonic_s())),
        *delays(site.rooms.delays(clock.monotonic_s())),
        *machine(shutil.disk_usage(site.data_dir).free, days_left(site.certificate, now_unix_s())),
    )
    return {"findings": [asdict(finding) for finding in known]}
