"""Know which tick of the room a picture shows: the newest whose state had come when it was captured. Pure.

Both times are of this machine's monotonic clock, whatever others' clocks say: no picture is told to be newer than it
is.
"""

from __future__ import annotations

import threading
from bisect import bisect_right
from collections import deque

_KEPT = 2048  # 100 s of 20 ticks a second


class TickTimes:
    """Keep when the newest ticks came. For any threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._times_s: deque[float] = deque(maxlen=_KEPT)
        self._ticks: deque[int] = deque(maxlen=_KEPT)
        self._boot = 0

    def add(self, tick: int, boot: int, received_s: float) -> None:
        """Take a tick that came at `received_s`; another `boot` is another run, whose ticks begin anew."""
        with self._lock:
            if boot != self._boot:
                self._boot = boot
                self._times_s.clear()
                self._ticks.clear()
            if not self._ticks or (tick > self._ticks[-1] and received_s >= self._times_s[-1]):
                self._times_s.append(received_s)
                self._ticks.append(tick)

    def tick_at(self, captured_s: float) -> int:
        """Return the tick that a picture of this time shows; 0 where none had come."""
        with self._lock:
            at = bisect_right(self._times_s, captured_s)
            return self._ticks[at - 1] if at else 0
