"""The peers of one seat: one browser, one phone, and whoever watches."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Sequence
from typing import Protocol

from mart.protocol.errors import Conflict
from mart.protocol.tokens import Role
from mart.runtime.bus.aio import AsyncBus
from mart.teleop_gateway.video.encoder import Codec, EncodedPicture
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.peer import Peer

MAX_VIEWERS = 8
SILENT_S = 10.0  # each peer pings once a second; aiortc alone finds a dead one after half a minute
_DRIVING = (Role.BROWSER, Role.PHONE)


class PeersListener(Protocol):
    """The seat, told on the event loop. Only peers that are present speak: a replaced one is silent at once."""

    def on_joined(self, peer: Peer) -> None: ...

    def on_left(self, peer: Peer) -> None: ...

    def on_pose(self, peer: Peer, payload: bytes) -> None: ...

    def on_status(self, peer: Peer, text: str) -> None: ...

    def on_keyframe_wanted(self, codec: Codec) -> None: ...


class Peers:
    def __init__(self, bus: AsyncBus, listener: PeersListener, ice_servers: Sequence[str]) -> None:
        self._bus = bus
        self._listener = listener
        self._ice_servers = ice_servers
        self._driving: dict[Role, Peer] = {}
        self._viewers: list[Peer] = []

    def __iter__(self) -> Iterator[Peer]:
        yield from self._driving.values()
        yield from self._viewers

    async def answer(self, role: Role, offer_sdp: str) -> str:
        """The answer's SDP, and a peer more; a driving role's earlier peer is replaced once the new one is answered.

        Raises InvalidInput where the offer cannot be used, Conflict where too many watch.
        """
        if role is Role.VIEWER and len(self._viewers) >= MAX_VIEWERS:
            raise Conflict(f"{MAX_VIEWERS} viewers watch this seat already; wait until one leaves.")
        peer = Peer(role, self, self._ice_servers)
        sdp = await peer.answer(offer_sdp)
        if role in self._driving:
            self._driving[role].send_status(status_channel.replaced())
            self._drop(self._driving[role])
        if role is Role.VIEWER:
            self._viewers.append(peer)
        else:
            self._driving[role] = peer
        self._listener.on_joined(peer)
        return sdp

    def codecs(self) -> frozenset[Codec]:
        """What is being watched."""
        return frozenset(peer.codec for peer in self if peer.codec is not None)

    def put(self, encoded: EncodedPicture) -> None:
        for peer in self:
            if peer.track is not None and peer.codec is encoded.codec:
                peer.track.put(encoded)

    def tell(self, text: str) -> None:
        for peer in self:
            peer.send_status(text)

    def drop_silent(self, now_s: float) -> None:
        for peer in [peer for peer in self if now_s - peer.heard_s > SILENT_S]:
            self._drop(peer)

    def drop_driving(self) -> None:
        """The seat has changed hands."""
        for peer in [peer for peer in self if peer.role in _DRIVING]:
            self._drop(peer)

    async def close(self) -> None:
        closing = [peer.close() for peer in self]
        self._driving.clear()
        self._viewers.clear()
        await asyncio.gather(*closing)

    # What a peer tells; one that was dropped is not heard any more.

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        if self._present(peer):
            self._listener.on_pose(peer, payload)

    def on_status(self, peer: Peer, text: str) -> None:
        if self._present(peer):
            self._listener.on_status(peer, text)

    def on_keyframe_wanted(self, codec: Codec) -> None:
        self._listener.on_keyframe_wanted(codec)

    def on_gone(self, peer: Peer) -> None:
        if self._present(peer):
            self._drop(peer)

    def _present(self, peer: Peer) -> bool:
        return any(peer is present for present in self)

    def _drop(self, peer: Peer) -> None:
        if self._driving.get(peer.role) is peer:
            del self._driving[peer.role]
        else:
            self._viewers.remove(peer)
        self._listener.on_left(peer)
        self._bus.spawn(peer.close())
