"""A seat's peers without connections, and who listens to them."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping

from mart.protocol.tokens import Role
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.video.encoder import Audience, Codec, Stream
from mart.teleop_gateway.voice.lanes import LanePacket
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peers import Peers

CONNECTS = "an offer of a page that connects"


class StubPeer:
    """A peer without a connection, last heard at 0 s."""

    codec: Codec | None = None
    track = None

    def __init__(
        self, role: Role, _listener: object, _ice_servers: object, holder_id: str, speaks_as: str = ""
    ) -> None:
        self.role = role
        self.holder_id = holder_id
        self.speaks_as = speaks_as
        self.heard_s = 0.0
        self.is_connected = False
        self.is_closed = False
        self.draws = False
        self.poses = b""
        self.played: list[LanePacket] = []
        self.audience = Audience.EVERYONE
        self.limit_bps = math.inf

    @property
    def stream(self) -> Stream | None:
        return None if self.codec is None or self.draws else Stream(self.codec, self.audience)

    def set_audience(self, audience: Audience) -> None:
        self.audience = audience

    async def answer(self, offer_sdp: str) -> str:
        await asyncio.sleep(0)
        self.is_connected = offer_sdp == CONNECTS
        return offer_sdp

    async def close(self) -> None:
        self.is_closed = True

    def send_status(self, text: str) -> None:
        """Nobody hears it."""

    def set_draws(self, draws: bool) -> None:
        self.draws = draws

    def play(self, packet: LanePacket) -> None:
        self.played.append(packet)

    def send_poses(self, message: bytes) -> None:
        self.poses = message


class Leavers:
    """Keeps the roles of those that left."""

    def __init__(self) -> None:
        self.left: list[Role] = []
        self.wished: list[Stream] = []

    def on_joined(self, peer: Peer) -> None:
        peer.heard_s = {Role.BROWSER: 100.0, Role.PHONE: 90.0, Role.VIEWER: 89.0}[peer.role]

    def on_left(self, peer: Peer) -> None:
        self.left.append(peer.role)

    def on_watched(self, limits_bps: Mapping[Stream, float]) -> None:
        """Nobody watches."""

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Nobody drives."""

    def on_status(self, peer: Peer, text: str) -> None:
        """Nobody speaks."""

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        """Nobody hears it."""

    def on_keyframe_wanted(self, stream: Stream) -> None:
        self.wished.append(stream)


async def seated() -> tuple[Peers, Leavers]:
    """A browser that was heard at 100 s, a phone at 90 s, and a viewer at 89 s."""
    peers = Peers(AsyncBus(MemoryNetwork().connect(), asyncio.get_running_loop()), list)
    leavers = Leavers()
    peers.attach(leavers)
    for role in (Role.BROWSER, Role.PHONE, Role.VIEWER):
        await peers.answer(role, "", "ana")
    return peers, leavers
