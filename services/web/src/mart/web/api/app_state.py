"""Everything a request may need, made once and handed to every route."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from pathlib import Path

from mart.protocol import clock
from mart.protocol.messages import Seat
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.ice_servers import IceSettings
from mart.web.access.pairing_codes import PairingCodes
from mart.web.access.request_limits import AtOnceLimit, FailureDelay, RequestLimit, TurnLimit
from mart.web.access.seat_switches import SeatSwitches
from mart.web.access.site_names import SiteNames
from mart.web.access.user_sessions import User, UserSessions
from mart.web.clients.catalogue_client import CatalogueClient
from mart.web.clients.gateway_client import GatewayClient
from mart.web.clients.platform_client import PlatformClient
from mart.web.clients.query_pools import QueryPools
from mart.web.clients.room_client import RoomRequester
from mart.web.clients.scene_store import SceneStore
from mart.web.clients.seat_switch import switch_seat
from mart.web.clients.trainer_client import TrainerClient
from mart.web.lobby.health_findings import RelayCheck
from mart.web.lobby.lobby import Lobby
from mart.web.lobby.rooms_text import RoomsText


def _wrong_codes() -> FailureDelay:
    return FailureDelay(free=5, window_s=600.0, step_s=0.1, longest_s=8.0)


def _joins() -> RequestLimit:
    return RequestLimit("people who joined", count=200, window_s=600.0)


def _offers() -> RequestLimit:
    return RequestLimit("connection attempts", count=30, window_s=60.0)


def _offers_from_address() -> RequestLimit:
    return RequestLimit("connection attempts", count=300, window_s=60.0)


def _writes() -> RequestLimit:
    return RequestLimit("changes", count=120, window_s=60.0)


def _browsing() -> TurnLimit:
    return TurnLimit(count=6)


def _live_sockets() -> AtOnceLimit:
    return AtOnceLimit("open pages", count=16)


@dataclass(frozen=True)
class AppState:
    """What all routes share; its maker closes what can be closed.

    `site`: what this site is called now.
    `ice`: the STUN and TURN servers that pages may use. `relays`: what became of asking them last, by URL.
    """

    bus: AsyncBus
    lobby: Lobby
    user_sessions: UserSessions
    join_code: str
    host_code: str
    secret: bytes
    site: SiteNames
    data_dir: Path
    certificate: Path
    pairing_codes: PairingCodes = field(default_factory=PairingCodes)
    seat_switches: SeatSwitches = field(default_factory=SeatSwitches)
    wrong_codes: FailureDelay = field(default_factory=_wrong_codes)
    wrong_host_codes: FailureDelay = field(default_factory=_wrong_codes)
    joins: RequestLimit = field(default_factory=_joins)
    offers: RequestLimit = field(default_factory=_offers)
    offers_from_address: RequestLimit = field(default_factory=_offers_from_address)
    writes: RequestLimit = field(default_factory=_writes)
    browsing: TurnLimit = field(default_factory=_browsing)
    live_sockets: AtOnceLimit = field(default_factory=_live_sockets)
    scenes: SceneStore = field(default_factory=SceneStore)
    ice: IceSettings = field(default_factory=IceSettings)
    relays: dict[str, RelayCheck] = field(default_factory=dict)

    @functools.cached_property
    def pools(self) -> QueryPools:
        """The bus for each kind of query."""
        return QueryPools(self.bus)

    @functools.cached_property
    def rooms_text(self) -> RoomsText:
        """The rooms as the live sockets send them."""
        return RoomsText(self.lobby)

    @property
    def rooms(self) -> RoomRequester:
        """The client through which seats are taken and episodes begun and ended."""
        return RoomRequester(self.pools.bus(ServiceKind.SIM), self.lobby)

    async def switch_seat(self, room: str, arm: str, user: User) -> Seat:
        """Give `user` the next arm that no other person drives instead of `arm`, and return its seat.

        Their phone goes with them. Raises what `mart.web.clients.seat_switch.switch_seat` raises.
        """
        seats = list(self.lobby.rooms.status(room, clock.monotonic_s()).seats)
        taken = await switch_seat(self.rooms, room, arm, user, seats)
        self.seat_switches.note(room, user.holder_id, arm, taken.arm)
        return taken

    @property
    def platform(self) -> PlatformClient:
        """The client through which rooms are opened and closed."""
        return PlatformClient(self.pools.bus(ServiceKind.PLATFORM), self.lobby)

    @property
    def gateways(self) -> GatewayClient:
        """The client that has peers' offers answered."""
        return GatewayClient(self.pools.bus(ServiceKind.GATEWAY), self.lobby)

    @property
    def catalogue(self) -> CatalogueClient:
        """The client that tells of recorded episodes."""
        return CatalogueClient(self.pools.bus(ServiceKind.CATALOGUE), self.lobby)

    @property
    def trainer(self) -> TrainerClient:
        """The client through which policies are trained and promoted."""
        return TrainerClient(self.pools.bus(ServiceKind.TRAINER), self.lobby)
