"""Hand what is to be painted to the view's thread; the newest wins."""

from __future__ import annotations

import threading
from collections.abc import Mapping

from mart.protocol import clock
from mart.teleop_gateway.video.encoder import Stream
from mart.teleop_gateway.video.picture_painter import UnpaintedPicture
from mart.teleop_gateway.video.seat_metrics import SKIPPED


class RenderQueue:
    """Hold the newest picture to paint and what is wanted of the next. Any thread may give; one thread takes."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._newest: UnpaintedPicture | None = None
        self._keyframes: set[Stream] = set()
        self._limits_bps: Mapping[Stream, float] = {}
        self._closed = False

    def offer(self, unpainted: UnpaintedPicture) -> None:
        """Put a newer one; one that nobody has taken yet is left out."""
        with self._changed:
            if self._newest is not None:
                SKIPPED.inc()
            self._newest = unpainted
            self._changed.notify()

    def request_keyframe(self, stream: Stream) -> None:
        """Want the next picture of this stream to be a keyframe."""
        with self._changed:
            self._keyframes.add(stream)
            self._changed.notify()

    def set_streams(self, limits_bps: Mapping[Stream, float]) -> None:
        """Tell which streams somebody watches, and their limits, bits a second."""
        with self._changed:
            self._limits_bps = dict(limits_bps)

    def close(self) -> None:
        """Tell whoever takes that there will be no more."""
        with self._changed:
            self._closed = True
            self._changed.notify()

    def wait(self, idle_s: float, keyframe_s: float) -> UnpaintedPicture | None:
        """Wait for a picture to paint; None after `idle_s`, or already after `keyframe_s` where a keyframe is wanted.

        Raises Closed when there will be no more.
        """
        start_s = clock.monotonic_s()
        with self._changed:
            while self._newest is None and not self._closed:
                patience_s = keyframe_s if self._keyframes else idle_s
                if not self._changed.wait(max(0.0, start_s + patience_s - clock.monotonic_s())):
                    return None
            if self._closed:
                raise RenderQueueClosed
            fresh, self._newest = self._newest, None
            return fresh

    def take_orders(self) -> tuple[Mapping[Stream, float], frozenset[Stream]]:
        """Return the streams that somebody watches with their limits, and those of which a keyframe is wanted.

        Each wish is told once.
        """
        with self._changed:
            wanted, self._keyframes = frozenset(self._keyframes), set()
            return self._limits_bps, wanted


class RenderQueueClosed(Exception):  # an end, not an error
    """Tell that there will be nothing more to paint."""
