"""Hold the peers of one seat: one browser, one phone, and whoever watches."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Protocol

from mart.protocol import clock
from mart.protocol.errors import Conflict
from mart.protocol.tokens import Role
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.ice_servers import IceServer
from mart.runtime.rate_limit import RateLimit
from mart.teleop_gateway.video.encoder import Audience, EncodedPicture, Stream
from mart.teleop_gateway.voice.lanes import LanePacket, Speaker
from mart.teleop_gateway.voice.room_voice import Talker
from mart.teleop_gateway.webrtc import status_channel
from mart.teleop_gateway.webrtc.peer import Peer

MAX_VIEWERS = 8
MAX_VIEWERS_A_PERSON = 2
SILENT_S = 10.0  # each peer pings once a second; aiortc alone finds a dead one after half a minute
_DRIVING = (Role.BROWSER, Role.PHONE)
_GOODBYES = (
    3  # the channel may lose messages, and a page that misses this one comes back and takes the seat again
)


class PeersListener(Protocol):
    """Be told on the event loop what peers do. Only those that are present speak: a replaced one is silent at once."""

    def on_joined(self, peer: Peer) -> None:
        """Take a new peer."""

    def on_left(self, peer: Peer) -> None:
        """Take the end of a peer, for whatever reason."""

    def on_watched(self, limits_bps: Mapping[Stream, float]) -> None:
        """Take which streams are watched, and with how many bits a second, whenever that changes."""

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Take a phone frame of a driving peer."""

    def on_status(self, peer: Peer, text: str) -> None:
        """Take a message of the status channel."""

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        """Take a packet of what a peer says."""

    def on_keyframe_wanted(self, stream: Stream) -> None:
        """Take that somebody cannot go on without a keyframe."""


class Peers:
    """Let peers in, tell and show all of them things, and let them go. Attach a listener before the first offer."""

    def __init__(self, bus: AsyncBus, ice_servers: Callable[[], Sequence[IceServer]]) -> None:
        """Keep a seat's peers. `ice_servers` returns the STUN and TURN servers that answer now."""
        self._bus = bus
        self._ice_servers = ice_servers
        self._listener: PeersListener | None = None
        self._driving: dict[Role, Peer] = {}
        self._viewers: list[Peer] = []
        self._viewers_wishes = RateLimit(1)
        self._told_bps: Mapping[Stream, float] = {}

    def __iter__(self) -> Iterator[Peer]:
        yield from self._driving.values()
        yield from self._viewers

    def attach(self, listener: PeersListener) -> None:
        """Tell `listener` what peers do from now on."""
        self._listener = listener

    async def answer(
        self,
        role: Role,
        offer_sdp: str,
        holder_id: str,
        speaks_as: str = "",
        speaks_until_s: float = math.inf,
    ) -> str:
        """Return the answer's SDP for the person with `holder_id`, who may speak by the name of `speaks_as`, if any.

        Who does not drive speaks until `speaks_until_s`, Unix time, unless that is renewed.

        A driving role's earlier peer is replaced once the new one is answered, and so is a person's oldest viewer where
        they watch twice already. Raises InvalidInput where the offer cannot be used, Conflict where too many watch.
        """
        peer = Peer(role, self, self._ice_servers(), holder_id, speaks_as)
        peer.speaks_until_s = speaks_until_s
        if role is Role.VIEWER:
            self._make_room(holder_id)
            self._viewers.append(peer)  # its place is taken before anything is awaited
        try:
            sdp = await peer.answer(offer_sdp)
        except BaseException:
            if peer in self._viewers:
                self._viewers.remove(peer)
            raise
        if role is not Role.VIEWER:
            self._replace(role, peer)
        elif peer not in self._viewers:
            raise Conflict("Others came to watch this seat meanwhile; try again.")
        if self._listener is not None:
            self._listener.on_joined(peer)
            self._tell_streams()
        return sdp

    def _make_room(self, holder_id: str) -> None:
        """Let viewers go who are in the way of one more: a person's own beyond two, those that do not connect."""
        own = [peer for peer in self._viewers if peer.holder_id == holder_id]
        for peer in own[: len(own) + 1 - MAX_VIEWERS_A_PERSON]:
            self._drop(peer)
        if len(self._viewers) >= MAX_VIEWERS:
            waiting = next((peer for peer in self._viewers if not peer.is_connected), None)
            if waiting is None:
                raise Conflict(f"{MAX_VIEWERS} viewers watch this seat already; wait until one leaves.")
            self._drop(waiting)

    def _replace(self, role: Role, peer: Peer) -> None:
        if role in self._driving:
            for _ in range(_GOODBYES):
                self._driving[role].send_status(status_channel.replaced())
            self._drop(self._driving[role])
        self._driving[role] = peer

    def streams(self) -> Mapping[Stream, float]:
        """Return the streams that are being watched, and how many bits a second the worst link to each carries."""
        limits_bps: dict[Stream, float] = {}
        for peer in self:
            if peer.stream is not None:
                limits_bps[peer.stream] = min(limits_bps.get(peer.stream, math.inf), peer.limit_bps)
        return limits_bps

    @property
    def any_draws(self) -> bool:
        """Whether any page draws by itself."""
        return any(peer.draws for peer in self)

    @property
    def holder_draws(self) -> bool:
        """Whether the page of whoever drives draws by itself."""
        browser = self._driving.get(Role.BROWSER)
        return browser is not None and browser.draws

    def set_draws(self, peer: Peer, draws: bool) -> None:
        """Take that a peer's page draws by itself, or wants video."""
        if peer.draws != draws:
            peer.set_draws(draws)
            self._tell_streams()

    def put(self, encoded: EncodedPicture) -> None:
        """Show a picture to all who watch its stream."""
        for peer in self:
            peer.show_video(encoded)

    def put_poses(self, message: bytes) -> None:
        """Tell all whose pages draw where the bodies are."""
        for peer in self:
            if peer.draws:
                peer.send_poses(message)

    def play(self, packet: LanePacket, but: Talker | None) -> None:
        """Let everybody hear a packet, except for who said it, on whichever of their devices. Phones hear nothing."""
        for peer in self:
            if peer.role is not Role.PHONE and (but is None or peer.holder_id != but.holder_id):
                peer.play(packet)

    def tell_voices(self, speakers: Sequence[Speaker], unheard: Collection[object]) -> None:
        """Tell everybody who speaks, and those who speak and are not heard that it is so."""
        for peer in self:
            if peer.role is not Role.PHONE or peer.speaks_as:
                peer.send_status(status_channel.voices(speakers, is_heard=peer not in unheard))

    def tell(self, text: str) -> None:
        """Send a message to all on their status channels."""
        for peer in self:
            peer.send_status(text)

    def tell_phones(self, text: str) -> None:
        """Send a message to phones alone: pages hear it from the web service."""
        for peer in self:
            if peer.role is Role.PHONE:
                peer.send_status(text)

    def drop_silent(self, now_s: float) -> None:
        """End the connections of peers that have said nothing for SILENT_S."""
        for peer in [peer for peer in self if now_s - peer.heard_s > SILENT_S]:
            self._drop(peer)

    def drop_driving(self) -> None:
        """End the connections of those who drove: the seat has changed hands."""
        for peer in [peer for peer in self if peer.role in _DRIVING]:
            self._drop(peer)

    async def close(self) -> None:
        """Return when every connection has ended; nobody is told."""
        closing = [peer.close() for peer in self]
        self._driving.clear()
        self._viewers.clear()
        await asyncio.gather(*closing)

    # What a peer tells; one that was dropped is not heard any more.

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Pass on a phone frame."""
        if self._listener is not None and self._is_present(peer):
            self._listener.on_pose(peer, payload)

    def on_status(self, peer: Peer, text: str) -> None:
        """Pass on a message of the status channel."""
        if self._listener is not None and self._is_present(peer):
            self._listener.on_status(peer, text)

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        """Pass on a packet of what a peer says."""
        if self._listener is not None and self._is_present(peer):
            self._listener.on_speech(peer, timestamp, opus)

    def on_keyframe_wanted(self, peer: Peer) -> None:
        """Pass on that a keyframe is wanted; of everyone's pictures one a second for all viewers.

        A keyframe is as large as ten other pictures, and whoever drives gets it, too. The next regular one is near.
        """
        stream = peer.stream
        if self._listener is None or stream is None:
            return
        spoils = peer.role is Role.VIEWER and stream.audience is Audience.EVERYONE
        if not spoils or self._viewers_wishes.allows(clock.monotonic_s()):
            self._listener.on_keyframe_wanted(stream)

    def on_limit(self) -> None:
        """Show whose link carries less than everyone's stream a stream for such, and the others everyone's."""
        for peer in self:
            own = Audience.VIEWERS if peer.role is Role.VIEWER else Audience.HOLDER
            peer.set_audience(Audience.EVERYONE if math.isinf(peer.limit_bps) else own)
        if self.streams() != self._told_bps:
            self._tell_streams()

    def on_gone(self, peer: Peer) -> None:
        """Let a peer go whose connection has ended by itself."""
        if self._is_present(peer):
            self._drop(peer)

    def _tell_streams(self) -> None:
        self._told_bps = self.streams()
        if self._listener is not None:
            self._listener.on_watched(self._told_bps)

    def _is_present(self, peer: Peer) -> bool:
        return any(peer is present for present in self)

    def _drop(self, peer: Peer) -> None:
        if self._driving.get(peer.role) is peer:
            del self._driving[peer.role]
        else:
            self._viewers.remove(peer)
        if self._listener is not None:
            self._listener.on_left(peer)
            self._tell_streams()
        self._bus.spawn(peer.close())
