"""Tell how fast a room really ticked. Pure: `now_s` comes in.

A machine that is too slow is so most of the time, and still; one on which a browser has just been started was so for
some seconds. What counts is therefore the median of short stretches, not the mean: of the last ones, or of the newest
where these were better.
"""

from __future__ import annotations

from collections import deque
from statistics import median

_STRETCH_S = 2.0  # of ticks: what one of them is late by changes it by a hundredth at most
_LAST, _NEWEST = 10, 3  # stretches


class TimeKept:
    """Count ticks against the time between them; a stretch longer than `stalled_after_s` is of who was waited for."""

    def __init__(self, stalled_after_s: float) -> None:
        self._stalled_after_s = stalled_after_s
        self.forget()

    def forget(self) -> None:
        """Begin anew, with the next tick."""
        self._rates_hz: deque[float] = deque(maxlen=_LAST)
        self._took_s, self._ticks = 0.0, 0
        self.interrupt()

    def interrupt(self) -> None:
        """Take that nothing was due since the last tick: the world began anew."""
        self._ticked_s: float | None = None

    def ticked(self, now_s: float) -> None:
        """Take that a tick has fired."""
        if self._ticked_s is not None and now_s - self._ticked_s <= self._stalled_after_s:
            self._took_s += now_s - self._ticked_s
            self._ticks += 1
        self._ticked_s = now_s
        if self._took_s >= _STRETCH_S:
            self._rates_hz.append(self._ticks / self._took_s)
            self._took_s, self._ticks = 0.0, 0

    def ticks_per_s(self) -> float | None:
        """Return the rate; None where too little was seen to tell."""
        if len(self._rates_hz) < _NEWEST:
            return None
        last = list(self._rates_hz)
        return max(median(last), median(last[-_NEWEST:]))
