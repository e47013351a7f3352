"""Listen to what one receiver reports of its pictures, and send packets twice where that spares it a wait.

A receiver that misses a packet asks for it, and gets it a round trip later: on a long way the picture stands still for
so long. A copy of each packet, sent a little later as if it had been asked for, comes in time; a burst of losses rarely
takes both.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from aiortc import RTCRtpSender

from mart.protocol import clock
from mart.teleop_gateway.webrtc.aiortc_hooks import on_feedback, on_packet_sent, send_again
from mart.teleop_gateway.webrtc.rate_control import RateControl, ReceiverReport

_COPY_AFTER_S = 0.06  # after the next picture: a burst of losses is over, and nobody sees a standstill yet


class SenderFeedback:
    """Hold what one sender may send. `on_limit` is called on the event loop whenever that may have changed."""

    def __init__(self, sender: RTCRtpSender, on_limit: Callable[[], None]) -> None:
        self._sender, self._on_limit = sender, on_limit
        self._rate = RateControl()
        self._closed = False
        self._sending: set[asyncio.Task[None]] = set()
        on_feedback(sender, self._on_report, self._on_estimate)
        on_packet_sent(sender, self._on_sent)

    @property
    def limit_bps(self) -> float:
        """Return how many bits a second of pictures the receiver can take; infinity without a limit."""
        return self._rate.limit_bps()

    def close(self) -> None:
        """Send no copies any more."""
        self._closed = True
        for task in self._sending:
            task.cancel()

    def _on_report(self, report: ReceiverReport) -> None:
        self._rate.on_report(report, clock.monotonic_s())
        self._on_limit()

    def _on_estimate(self, bitrate_bps: int) -> None:
        self._rate.on_estimate(bitrate_bps, clock.monotonic_s())
        self._on_limit()

    def _on_sent(self, sequence_number: int, size_bytes: int) -> None:
        copies = self._rate.copies and not self._closed
        self._rate.on_sent((2 if copies else 1) * size_bytes, clock.monotonic_s())
        if copies:
            task = asyncio.ensure_future(self._copy(sequence_number))
            self._sending.add(task)
            task.add_done_callback(self._sending.discard)

    async def _copy(self, sequence_number: int) -> None:
        await asyncio.sleep(_COPY_AFTER_S)
        await send_again(self._sender, sequence_number)
