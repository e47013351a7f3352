"""Do with voices what aiortc 1.16 has no public way for.

tests/teleop_gateway/webrtc/test_peer_audio.py fails if it moves.
"""

from __future__ import annotations

import uuid
from collections.abc import Callable

from aiortc import RTCPeerConnection, RTCRtpReceiver, RTCRtpSender, RTCRtpTransceiver, rtp

# What a browser is asked to send: a voice (RFC 7587, section 6.1), with which a lost packet can be made up for.
_ASKED_FOR: dict[str, int | str | None] = {"maxaveragebitrate": 32_000, "minptime": 10, "useinbandfec": 1}


def on_audio_packet(receiver: RTCRtpReceiver, handler: Callable[[int, bytes], None]) -> None:
    """Call `handler` with the time stamp and the payload of every packet, instead of decoding it."""

    async def pass_on(packet: rtp.RtpPacket, arrival_time_ms: int) -> None:
        del arrival_time_ms
        handler(packet.timestamp, packet.payload)

    receiver._handle_rtp_packet = pass_on  # type: ignore[method-assign]  # noqa: SLF001


def apart_from_video(sender: RTCRtpSender) -> None:
    """Make what is sent a stream of its own: a browser shows the pictures of one stream when its sound is played."""
    sender._stream_id = str(uuid.uuid4())  # noqa: SLF001


def give_transport(connection: RTCPeerConnection, transceiver: RTCRtpTransceiver) -> None:
    """Give a transceiver that is new a transport of its own, where it has none, as the first of a kind has.

    The second shares the first's, and when both are to move to the one of the bundle, aiortc leaves it behind.
    """
    if not transceiver._bundled:  # noqa: SLF001
        return
    transport = connection._RTCPeerConnection__createDtlsTransport()  # type: ignore[attr-defined]  # noqa: SLF001
    transceiver.receiver.setTransport(transport)
    transceiver.sender.setTransport(transport)
    transceiver._bundled = False  # noqa: SLF001


def ask_for_voice(transceiver: RTCRtpTransceiver) -> None:
    """Tell the peer, in the answer that is made next, how to encode what it says."""
    for negotiated in transceiver._codecs:  # noqa: SLF001
        negotiated.parameters = {**negotiated.parameters, **_ASKED_FOR}
