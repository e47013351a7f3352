"""Everything a request may need, made once and handed to every route."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.web.catalogue import Catalogue
from mart.web.limits import RateLimit
from mart.web.pairing import PairingCodes
from mart.web.people import People
from mart.web.rooms import Rooms
from mart.web.trainer import Trainer


def _wrong_codes() -> RateLimit:
    return RateLimit("wrong codes", count=5, window_s=60.0)


def _offers() -> RateLimit:
    return RateLimit("connection attempts", count=30, window_s=60.0)


@dataclass(frozen=True)
class Site:
    """`names`: what this site is called. `lan_host`: what a phone may call it; empty where it cannot reach it."""

    bus: AsyncBus
    rooms: Rooms
    people: People
    join_code: str
    secret: bytes
    names: tuple[str, ...]
    lan_host: str
    data_dir: Path
    certificate: Path
    pairing: PairingCodes = field(default_factory=PairingCodes)
    wrong_codes: RateLimit = field(default_factory=_wrong_codes)
    offers: RateLimit = field(default_factory=_offers)

    @property
    def catalogue(self) -> Catalogue:
        return Catalogue(self.bus, lambda: self.rooms.services().get(ServiceKind.CATALOGUE, []))

    @property
    def trainer(self) -> Trainer:
        return Trainer(self.bus, lambda: self.rooms.services().get(ServiceKind.TRAINER, []))
