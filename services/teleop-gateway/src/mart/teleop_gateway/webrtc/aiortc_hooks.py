"""Do what aiortc 1.16 has no public way for; tests/teleop_gateway/webrtc/test_aiortc_hooks.py fails if it moves.

Playout delay (webrtc.googlesource.com, docs/native-code/rtp-hdrext/playout-delay): an RTP header extension by which a
sender tells how long a receiver may hold a picture. (0, 0) means show it at once: worth 14 ms in Chromium, and the
picture comes more steadily than with the receiver's own smoothing.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable

from aiortc import RTCPeerConnection, RTCRtpSender, RTCRtpTransceiver, RTCSctpTransport, rtp
from aiortc.codecs import HEADER_EXTENSIONS
from aiortc.rtcrtpparameters import RTCRtpHeaderExtensionParameters, RTCRtpParameters

from mart.protocol import clock
from mart.teleop_gateway.webrtc.rate_control import ReceiverReport

PLAYOUT_DELAY_URI = "http://www.webrtc.org/experiments/rtp-hdrext/playout-delay"
_FREE_ID = 4  # aiortc takes 1 to 3; a browser that offers the extension brings its own number
_NO_DELAY = bytes(3)  # 12 bits of minimum, 12 bits of maximum, in steps of 10 ms
_LEAST_WINDOW_BYTES = 16 * 1200  # statuses and poses of a room of 60 Hz in a round trip of 0.3 s are 13 kB


def offer_playout_delay() -> None:
    """Make every connection of this process negotiate the extension; call it before the first, again is harmless."""
    video = HEADER_EXTENSIONS["video"]
    if all(extension.uri != PLAYOUT_DELAY_URI for extension in video):
        video.append(RTCRtpHeaderExtensionParameters(id=_FREE_ID, uri=PLAYOUT_DELAY_URI))


def show_at_once(sender: RTCRtpSender) -> None:
    """Put a playout delay of (0, 0) on every packet of this sender, where the peer negotiated it."""
    sender._RTCRtpSender__rtp_header_extensions_map = _NoPlayoutDelay()  # type: ignore[attr-defined]  # noqa: SLF001


def on_keyframe_request(sender: RTCRtpSender, handler: Callable[[], None]) -> None:
    """Call `handler` on PLI and FIR: a sender of encoded pictures only sets a flag that nobody reads."""
    sender._send_keyframe = handler  # type: ignore[method-assign]  # noqa: SLF001


def on_feedback(
    sender: RTCRtpSender, on_report: Callable[[ReceiverReport], None], on_estimate: Callable[[int], None]
) -> None:
    """Call `on_report` with every report of the receiver, `on_estimate` with what it can receive, bits a second."""
    handle = sender._handle_rtcp_packet  # noqa: SLF001

    async def handle_and_tell(packet: rtp.AnyRtcpPacket) -> None:
        await handle(packet)
        if isinstance(packet, rtp.RtcpRrPacket | rtp.RtcpSrPacket):
            for info in packet.reports:
                if info.ssrc == sender._ssrc:  # noqa: SLF001
                    round_trip_s = _round_trip_s(sender, info)
                    on_report(ReceiverReport(info.packets_lost, info.highest_sequence, round_trip_s))
        elif isinstance(packet, rtp.RtcpPsfbPacket) and packet.fmt == rtp.RTCP_PSFB_APP:
            estimate_bps = _estimate_bps(packet, sender)
            if estimate_bps is not None:
                on_estimate(estimate_bps)

    sender._handle_rtcp_packet = handle_and_tell  # type: ignore[method-assign]  # noqa: SLF001


def on_packet_sent(sender: RTCRtpSender, handler: Callable[[int, int], None]) -> None:
    """Call `handler` with the sequence number and the bytes of every packet that is sent for the first time."""
    sender._RTCRtpSender__rtp_history = _SentPackets(handler)  # type: ignore[attr-defined]  # noqa: SLF001


async def send_again(sender: RTCRtpSender, sequence_number: int) -> None:
    """Send a packet once more, as its retransmission; nothing where it was sent long ago, or the connection ended."""
    with contextlib.suppress(ConnectionError):
        await sender._retransmit(sequence_number)  # noqa: SLF001


def on_unreadable(sctp: RTCSctpTransport, handler: Callable[[Exception], None]) -> None:
    """Call `handler` where a peer's data trips the parser: aiortc ends its receiving there, and tells nobody."""
    receive = sctp._handle_data  # noqa: SLF001

    async def receive_all(data: bytes) -> None:
        try:
            await receive(data)
        except ConnectionError:
            raise
        except Exception as error:  # noqa: BLE001 - whatever the parser or a listener trips over
            handler(error)

    sctp._handle_data = receive_all  # type: ignore[method-assign]  # noqa: SLF001


def keep_window(sctp: RTCSctpTransport) -> None:
    """Let what is sent all the time be sent at its rate after a loss or an outage, too (docs/decisions/0080).

    SCTP (RFC 9260) would send one packet a round trip then, and the page would hear its seat three times a second.
    """
    sctp.__class__ = _WideWindow


async def close_connection(connection: RTCPeerConnection) -> None:
    """End a connection, also one whose offer was refused halfway: aiortc then fails, and leaves its sockets open."""
    try:
        await connection.close()
    except AttributeError:  # of a transport that it never got to
        for transport in connection._RTCPeerConnection__iceTransports:  # type: ignore[attr-defined]  # noqa: SLF001
            await transport.stop()


def sent_codec(transceiver: RTCRtpTransceiver) -> str:
    """Return the codec that was negotiated for sending: "H264", "VP8"."""
    return transceiver._codecs[0].name  # noqa: SLF001


def _round_trip_s(sender: RTCRtpSender, info: rtp.RtcpReceiverInfo) -> float:
    """Return how long sender's newest report and its answer took; NaN where the answer is to an older one.

    NaN also where the clock was set back meanwhile.
    """
    if not info.dlsr or info.lsr != sender._RTCRtpSender__lsr:  # type: ignore[attr-defined]  # noqa: SLF001
        return math.nan
    sent_s: float = sender._RTCRtpSender__lsr_time  # type: ignore[attr-defined]  # noqa: SLF001
    took_s = clock.wall_ns() * 1e-9 - sent_s - info.dlsr / 65_536
    return took_s if took_s >= 0 else math.nan


def _estimate_bps(packet: rtp.RtcpPsfbPacket, sender: RTCRtpSender) -> int | None:
    try:
        estimate_bps, sources = rtp.unpack_remb_fci(packet.fci)
    except ValueError:
        return None
    return estimate_bps if sender._ssrc in sources else None  # noqa: SLF001


class _WideWindow(RTCSctpTransport):
    """Never closes its congestion window further than to what our messages take."""

    @property
    def _cwnd(self) -> int:
        return max(_LEAST_WINDOW_BYTES, int(self.__dict__["_cwnd"]))

    @_cwnd.setter
    def _cwnd(self, size_bytes: int) -> None:
        self.__dict__["_cwnd"] = size_bytes


class _SentPackets(dict[int, rtp.RtpPacket]):
    def __init__(self, handler: Callable[[int, int], None]) -> None:
        super().__init__()
        self._handler = handler

    def __setitem__(self, slot: int, packet: rtp.RtpPacket) -> None:
        super().__setitem__(slot, packet)
        self._handler(packet.sequence_number, len(packet.payload))


class _NoPlayoutDelay(rtp.HeaderExtensionsMap):
    def __init__(self) -> None:
        super().__init__()
        self._id: int | None = None

    def configure(self, parameters: RTCRtpParameters) -> None:
        super().configure(parameters)
        for extension in parameters.headerExtensions:
            if extension.uri == PLAYOUT_DELAY_URI:
                self._id = extension.id

    def set(self, values: rtp.HeaderExtensions) -> tuple[int, bytes]:
        profile, packed = super().set(values)
        if self._id is None:
            return profile, packed
        extensions = rtp.unpack_header_extensions(profile, packed)
        return rtp.pack_header_extensions([*extensions, (self._id, _NO_DELAY)])
