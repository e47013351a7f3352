"""Everything a request may need, made once and handed to every route."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from mart.runtime.bus.aio import AsyncBus
from mart.runtime.ice_servers import IceSettings
from mart.web.access.pairing_codes import PairingCodes
from mart.web.access.request_limits import RequestLimit
from mart.web.access.user_sessions import UserSessions
from mart.web.clients.catalogue_client import CatalogueClient
from mart.web.clients.gateway_client import GatewayClient
from mart.web.clients.platform_client import PlatformClient
from mart.web.clients.room_client import RoomRequester
from mart.web.clients.trainer_client import TrainerClient
from mart.web.lobby.health_findings import RelayCheck
from mart.web.lobby.lobby import Lobby


def _wrong_codes() -> RequestLimit:
    return RequestLimit("wrong codes", count=5, window_s=60.0)


def _offers() -> RequestLimit:
    return RequestLimit("connection attempts", count=30, window_s=60.0)


@dataclass(frozen=True)
class AppState:
    """What all routes share; its maker closes what can be closed.

    `names`: what this site is called. `lan_host`: what a phone may call it; empty where it cannot reach it.
    `ice`: the STUN and TURN servers that pages may use. `relays`: what became of asking them last, by URL.
    """

    bus: AsyncBus
    lobby: Lobby
    user_sessions: UserSessions
    join_code: str
    secret: bytes
    names: tuple[str, ...]
    lan_host: str
    data_dir: Path
    certificate: Path
    pairing_codes: PairingCodes = field(default_factory=PairingCodes)
    wrong_codes: RequestLimit = field(default_factory=_wrong_codes)
    offers: RequestLimit = field(default_factory=_offers)
    ice: IceSettings = field(default_factory=IceSettings)
    relays: dict[str, RelayCheck] = field(default_factory=dict)

    @property
    def rooms(self) -> RoomRequester:
        """The client through which seats are taken and episodes begun and ended."""
        return RoomRequester(self.bus, self.lobby)

    @property
    def platform(self) -> PlatformClient:
        """The client through which rooms are opened and closed."""
        return PlatformClient(self.bus, self.lobby.services)

    @property
    def gateways(self) -> GatewayClient:
        """The client that has peers' offers answered."""
        return GatewayClient(self.bus, self.lobby.services)

    @property
    def catalogue(self) -> CatalogueClient:
        """The client that tells of recorded episodes."""
        return CatalogueClient(self.bus, self.lobby.services)

    @property
    def trainer(self) -> TrainerClient:
        """The client through which policies are trained and promoted."""
        return TrainerClient(self.bus, self.lobby.services)
