"""Show how the site does: who is connected, and what it knows of the platform."""

from __future__ import annotations

import asyncio

from prometheus_client import Gauge

from mart.protocol import clock
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.metrics import REGISTRY
from mart.web.access.connection_table import ConnectionTable
from mart.web.lobby.lobby import Lobby

CONNECTIONS = Gauge(
    "mart_web_connections", "Connections of browsers and phones that are open.", registry=REGISTRY
)
SERVICES = Gauge("mart_web_live_services", "Services that are alive, by kind.", ("kind",), registry=REGISTRY)
ROOMS = Gauge(
    "mart_web_rooms",
    "Rooms as the lobby shows them: answering, silent (which do not answer) or slow.",
    ("state",),
    registry=REGISTRY,
)

_LOOK_EVERY_S = 1.0


async def keep_shown(lobby: Lobby, connections: ConnectionTable) -> None:
    """Take the figures once a second, until cancelled."""
    while True:
        show_site(lobby, len(connections), clock.monotonic_s())
        await asyncio.sleep(_LOOK_EVERY_S)


def show_site(lobby: Lobby, connections: int, now_s: float) -> None:
    """Take how the site stands. now_s: monotonic seconds."""
    CONNECTIONS.set(connections)
    for kind in ServiceKind:
        SERVICES.labels(kind).set(len(lobby.services.ids(kind)))
    names = lobby.rooms.names(now_s)
    silent = sum(lobby.rooms.is_stale(room, now_s) for room in names)
    ROOMS.labels("silent").set(silent)
    ROOMS.labels("answering").set(len(names) - silent)
    ROOMS.labels("slow").set(sum(lobby.rooms.is_slow(room, now_s) for room in names))
