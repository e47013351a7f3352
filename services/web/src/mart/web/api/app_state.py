"""Everything a request may need, made once and handed to every route."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.web.access.pairing_codes import PairingCodes
from mart.web.access.request_limits import RateLimit
from mart.web.access.user_sessions import UserSessions
from mart.web.clients.catalogue_client import CatalogueClient
from mart.web.clients.trainer_client import TrainerClient
from mart.web.lobby.rooms import Rooms


def _wrong_codes() -> RateLimit:
    return RateLimit("wrong codes", count=5, window_s=60.0)


def _offers() -> RateLimit:
    return RateLimit("connection attempts", count=30, window_s=60.0)


@dataclass(frozen=True)
class AppState:
    """`names`: what this site is called. `lan_host`: what a phone may call it; empty where it cannot reach it."""

    bus: AsyncBus
    rooms: Rooms
    user_sessions: UserSessions
    join_code: str
    secret: bytes
    names: tuple[str, ...]
    lan_host: str
    data_dir: Path
    certificate: Path
    pairing_codes: PairingCodes = field(default_factory=PairingCodes)
    wrong_codes: RateLimit = field(default_factory=_wrong_codes)
    offers: RateLimit = field(default_factory=_offers)

    @property
    def catalogue(self) -> CatalogueClient:
        return CatalogueClient(self.bus, lambda: self.rooms.services().get(ServiceKind.CATALOGUE, []))

    @property
    def trainer(self) -> TrainerClient:
        return TrainerClient(self.bus, lambda: self.rooms.services().get(ServiceKind.TRAINER, []))
