"""Hold one WebRTC peer of a seat: a browser, a phone or a viewer."""

from __future__ import annotations

import asyncio
import logging
import math
from collections.abc import Sequence
from typing import Protocol

from aiortc import (
    RTCConfiguration,
    RTCDataChannel,
    RTCIceServer,
    RTCPeerConnection,
    RTCRtpSender,
    RTCRtpTransceiver,
    RTCSessionDescription,
)

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.protocol.queryables import MAX_SDP_CHARACTERS
from mart.protocol.tokens import Role
from mart.runtime.ice_servers import IceServer
from mart.runtime.rate_limit import RateLimit
from mart.teleop_gateway.video.encoder import Audience, Codec, EncodedPicture, Stream
from mart.teleop_gateway.voice.lanes import LanePacket
from mart.teleop_gateway.webrtc.aiortc_hooks import (
    close_connection,
    keep_window,
    offer_playout_delay,
    on_keyframe_request,
    on_unreadable,
    sent_codec,
    show_at_once,
)
from mart.teleop_gateway.webrtc.ice_candidates import bounded_candidates
from mart.teleop_gateway.webrtc.named_candidates import add_named
from mart.teleop_gateway.webrtc.offered_media import offered_media
from mart.teleop_gateway.webrtc.peer_audio import PeerAudio
from mart.teleop_gateway.webrtc.sender_feedback import SenderFeedback
from mart.teleop_gateway.webrtc.track import EncodedTrack

_log = logging.getLogger(__name__)

MAX_STATUS_PER_S = 50
_STALE_BYTES = 4 * 1024  # a channel with this much waiting gets no more telemetry: the next is worth more
_GONE = ("closed", "failed")


class PeerListener(Protocol):
    """Be told what a peer does; always on the event loop."""

    def on_pose(self, peer: Peer, payload: bytes) -> None:
        """Take a message of its pose channel."""

    def on_status(self, peer: Peer, text: str) -> None:
        """Take a message of its status channel."""

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        """Take a packet of what it says, of a peer that may speak."""

    def on_keyframe_wanted(self, peer: Peer) -> None:
        """Take that it cannot go on without a keyframe."""

    def on_limit(self) -> None:
        """Take that its link may carry more or less than it did."""

    def on_gone(self, peer: Peer) -> None:
        """Take that its connection has ended."""


class Peer:
    """Hold one connection: answer its offer, then let it run; `close` ends it, also when it is already gone."""

    def __init__(
        self,
        role: Role,
        listener: PeerListener,
        ice_servers: Sequence[IceServer] = (),
        holder_id: str = "",
        speaks_as: str = "",
    ) -> None:
        """Make a peer of the person with `holder_id`, who may speak by the name of `speaks_as`, if any."""
        offer_playout_delay()
        self.role = role
        self.holder_id = holder_id
        self.speaks_as = speaks_as
        self.speaks_until_s = math.inf  # Unix time; counts for who does not drive
        self.codec: Codec | None = None
        self.track: EncodedTrack | None = None
        self._audience = Audience.EVERYONE
        self._feedback: SenderFeedback | None = None
        self._audio: PeerAudio | None = None
        self.clock_offset_ns: int | None = None  # gateway clock minus the peer's, once it has told
        self.heard_s = clock.monotonic_s()
        self.draws = False  # its page draws by itself: it wants poses and no video
        self._listener = listener
        self._status_rate = RateLimit(MAX_STATUS_PER_S)
        self._status: RTCDataChannel | None = None
        self._looking_up: asyncio.Task[None] | None = None
        self._bodies: RTCDataChannel | None = None
        # An empty list, or aiortc asks a public STUN server and waits for it.
        self._connection = RTCPeerConnection(RTCConfiguration([*map(as_aiortc, ice_servers)]))
        self._connection.on("datachannel", self._on_channel)
        self._connection.on("connectionstatechange", self._on_state)

    async def answer(self, offer_sdp: str) -> str:
        """Return the answer's SDP; raises InvalidInput where the offer cannot be used. The peer is closed then."""
        if len(offer_sdp) > MAX_SDP_CHARACTERS:
            raise InvalidInput(
                f"An offer of {len(offer_sdp)} characters was given; {MAX_SDP_CHARACTERS} are allowed."
            )
        try:
            await self._negotiate(offer_sdp)
        except Exception as error:  # a malformed SDP raises whatever the parser trips over
            await self.close()
            raise InvalidInput(f"An offer was given that cannot be answered: {error}") from error
        return self._connection.localDescription.sdp

    @property
    def is_connected(self) -> bool:
        """Whether the connection has come about."""
        return self._connection.connectionState == "connected"

    def send_status(self, text: str) -> None:
        """Send a message; it is dropped where the channel is not open, or still busy with older ones."""
        _send(self._status, text)

    def send_poses(self, message: bytes) -> None:
        """Send where the bodies are; dropped like a message of the status channel: the next tick's is newer."""
        _send(self._bodies, message)

    @property
    def stream(self) -> Stream | None:
        """Return the stream whose pictures it is shown; None where it needs none."""
        return None if self.codec is None or self.draws else Stream(self.codec, self._audience)

    @property
    def limit_bps(self) -> float:
        """Return how many bits a second of pictures its link carries; infinity where nothing says so."""
        return self._feedback.limit_bps if self._feedback is not None else math.inf

    def show_video(self, encoded: EncodedPicture) -> None:
        """Send a picture of its stream."""
        if self.track is not None and self.stream == encoded.stream:
            self.track.put(encoded)

    def play(self, packet: LanePacket) -> None:
        """Let it hear a packet, where its page asked for sound."""
        if self._audio is not None:
            self._audio.play(packet)

    def set_audience(self, audience: Audience) -> None:
        """Show it the stream for these from now on, which begins with a keyframe."""
        if audience is not self._audience:
            self._audience = audience
            if self.track is not None:
                self.track.restart()

    def set_draws(self, draws: bool) -> None:
        """Take whether its page draws by itself; where it does not any more, video begins with a keyframe."""
        restarts = self.draws and not draws
        self.draws = draws
        if restarts and self.track is not None:
            self.track.restart()

    async def close(self) -> None:
        """Return when the connection has ended."""
        if self._looking_up is not None:
            self._looking_up.cancel()
        if self.track is not None:
            self.track.stop()
        if self._audio is not None:
            self._audio.close()
        if self._feedback is not None:
            self._feedback.close()
        await close_connection(self._connection)

    async def _negotiate(self, offer_sdp: str) -> None:
        wanted = offered_media(offer_sdp, phone=self.role is Role.PHONE)
        video = self._add_video() if wanted.video else None
        audio = self._audio = PeerAudio(self._connection, wanted.audio)
        if self.speaks_as:
            audio.listen(lambda timestamp, opus: self._listener.on_speech(self, timestamp, opus))
        sdp, named = bounded_candidates(offer_sdp)
        # The browser knows first that packets come through, so it begins the handshake: a round trip less.
        sdp = sdp.replace("a=setup:actpass", "a=setup:active")
        offer = RTCSessionDescription(sdp, "offer")
        await self._connection.setRemoteDescription(offer)
        audio.ask_for_voice()
        if self._connection.sctp is not None:
            on_unreadable(self._connection.sctp, self._on_unreadable)
            keep_window(self._connection.sctp)
        await self._connection.setLocalDescription(await self._connection.createAnswer())
        if video is not None:
            self.codec = Codec(sent_codec(video))
        if named:
            self._looking_up = asyncio.create_task(add_named(self._connection, named))

    def _add_video(self) -> RTCRtpTransceiver:
        self.track = EncodedTrack(self._want_keyframe)
        transceiver = self._connection.addTransceiver(self.track, "sendonly")
        sender = transceiver.sender
        show_at_once(sender)
        on_keyframe_request(sender, self._want_keyframe)
        self._feedback = SenderFeedback(sender, self._listener.on_limit)
        codecs = RTCRtpSender.getCapabilities("video").codecs
        order = {"video/H264": 0, "video/VP8": 1, "video/rtx": 2}
        transceiver.setCodecPreferences(sorted(codecs, key=lambda codec: order[codec.mimeType]))
        return transceiver

    def _want_keyframe(self) -> None:
        self._listener.on_keyframe_wanted(self)

    def _on_channel(self, channel: RTCDataChannel) -> None:
        if channel.label == "pose":
            if self.role is not Role.VIEWER:  # a page opens it before it knows whether it drives
                channel.on("message", self._on_pose)
        elif channel.label == "bodies" and self.role is not Role.PHONE:
            self._bodies = channel
        elif channel.label == "status":
            self._status = channel
            channel.on("message", self._on_status)
        else:
            _log.warning("A %s opened a channel %r that it may not have", self.role, channel.label[:40])

    def _on_pose(self, message: bytes | str) -> None:
        self.heard_s = clock.monotonic_s()
        self._listener.on_pose(self, message if isinstance(message, bytes) else message.encode())

    def _on_status(self, message: bytes | str) -> None:
        self.heard_s = clock.monotonic_s()
        if self._status_rate.allows(self.heard_s):
            self._listener.on_status(
                self, message if isinstance(message, str) else message.decode(errors="replace")
            )

    def _on_unreadable(self, error: Exception) -> None:
        _log.info("What a %s sent cannot be read, its connection is ended: %r", self.role, error)
        self._listener.on_gone(self)

    def _on_state(self) -> None:
        _log.debug("%s: %s", self.role, self._connection.connectionState)
        if self._connection.connectionState in _GONE:
            self._listener.on_gone(self)


def _send(channel: RTCDataChannel | None, message: str | bytes) -> None:
    if channel is not None and channel.readyState == "open" and channel.bufferedAmount < _STALE_BYTES:
        channel.send(message)


def as_aiortc(server: IceServer) -> RTCIceServer:
    """Return a server as aiortc takes it."""
    return RTCIceServer(server.url, server.username or None, server.credential or None)
