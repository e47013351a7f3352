"""Count a press for a word to one's partners once: it is told several times, because messages may be lost. Pure."""

from __future__ import annotations

from collections import deque

from mart.runtime.rate_limit import RateLimit

MAX_PER_S = 2
_REMEMBERED = 8


class CueFilter:
    """Remember the presses of one seat's holder, and let each through once."""

    def __init__(self) -> None:
        self._rate = RateLimit(MAX_PER_S)
        self._known: deque[float] = deque(maxlen=_REMEMBERED)

    def allow(self, press_us: float, now_s: float) -> bool:
        """Tell whether this press is new and not one too many; such a one stays refused, however often it is told."""
        if press_us in self._known:
            return False
        self._known.append(press_us)
        return self._rate.allows(now_s)
