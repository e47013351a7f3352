"""Hold the audio of one peer: a lane to each of the voices that it hears, the first also for its own."""

from __future__ import annotations

from collections.abc import Callable

from aiortc import RTCPeerConnection, RTCRtpReceiver, RTCRtpTransceiver

from mart.teleop_gateway.voice.lanes import LANES, LanePacket
from mart.teleop_gateway.webrtc.audio_hooks import (
    apart_from_video,
    ask_for_voice,
    give_transport,
    on_audio_packet,
)
from mart.teleop_gateway.webrtc.voice_track import VoiceTrack


class PeerAudio:
    """Answer the audio sections of an offer, at most LANES; a peer whose offer has none neither hears nor speaks.

    Whoever may not speak has their first section answered like the others: nothing that they send is looked at.
    """

    def __init__(self, connection: RTCPeerConnection, lanes: int) -> None:
        """Prepare `connection` for an offer with that many audio sections, before the offer is given to it."""
        self._tracks = [VoiceTrack() for _ in range(min(lanes, LANES))]
        self._transceivers = [self._add(connection, track) for track in self._tracks]

    def listen(self, on_speech: Callable[[int, bytes], None]) -> None:
        """Call `on_speech` with the time stamp and the Opus packet of what the peer says. Call it before the answer."""
        if self._transceivers:
            first = self._transceivers[0]
            first.direction = "sendrecv"
            on_audio_packet(first.receiver, on_speech)

    def ask_for_voice(self) -> None:
        """Say how voices are to be encoded, between offer and answer."""
        for transceiver in self._transceivers:
            ask_for_voice(transceiver)

    def play(self, packet: LanePacket) -> None:
        """Let the peer hear a packet."""
        if packet.lane < len(self._tracks):
            self._tracks[packet.lane].put(packet)

    def close(self) -> None:
        """End the tracks."""
        for track in self._tracks:
            track.stop()

    def _add(self, connection: RTCPeerConnection, track: VoiceTrack) -> RTCRtpTransceiver:
        transceiver = connection.addTransceiver(track, "sendonly")
        give_transport(connection, transceiver)
        apart_from_video(transceiver.sender)
        known = RTCRtpReceiver.getCapabilities("audio")
        opus = [codec for codec in known.codecs if codec.mimeType == "audio/opus"] if known else []
        transceiver.setCodecPreferences(opus)
        return transceiver
