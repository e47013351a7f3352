"""How everything does: for machines in one word, for people with what to do."""

from __future__ import annotations

import os
import shutil
from dataclasses import asdict

from fastapi import APIRouter, Request

from mart.protocol import clock
from mart.protocol.vocabulary import ServiceKind
from mart.web.access.certificate import days_left
from mart.web.access.site_names import is_loopback
from mart.web.api.dependencies import Address, App, JoinedUser, now_unix_s
from mart.web.lobby.health_findings import cameras, delays, machine, pictures, relays, rooms, services
from mart.web.lobby.room_json import Json

router = APIRouter(prefix="/api/health")

_EXPECTED = (ServiceKind.SIM, ServiceKind.GATEWAY, ServiceKind.RECORDER)


@router.get("")
async def health(request: Request, app: App, address: Address) -> Json:
    """Send who is alive, and as `ok` whether everything that a collection session needs is there.

    Who asks from this machine is told as `urls` how other devices reach the lobby; others need not know its networks.
    """
    running = app.lobby.services.by_kind()
    told = {"ok": all(kind in running for kind in _EXPECTED), "services": running}
    if is_loopback(address):
        told["urls"] = app.site.urls_for_others(request.headers["host"])
    return told


@router.get("/findings")
async def findings(app: App, _user: JoinedUser) -> Json:
    """Send everything that is known of the platform's health, each problem with its mend."""
    seen = app.lobby.rooms_json("", clock.monotonic_s())
    known = (
        *services(app.lobby.services.by_kind()),
        *rooms(seen),
        *cameras(seen),
        *delays(app.lobby.latencies.fresh(clock.monotonic_s()), os.getloadavg()[0] / (os.cpu_count() or 1)),
        *pictures(app.lobby.missing_pictures.fresh(clock.monotonic_s())),
        *machine(shutil.disk_usage(app.data_dir).free, days_left(app.certificate, now_unix_s())),
        *relays(app.relays),
    )
    return {"findings": [asdict(finding) for finding in known]}
