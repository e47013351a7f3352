"""Tell when the next tick may fire, and how fast the world's time has been running. Pure: `now_s` comes in.

Ticks are due at a fixed rhythm. A late one does not move the rhythm, so the average rate stays exact; but lateness of
more than `CATCH_UP_TICKS` periods is forgiven: after a stall the world runs at most that many ticks ahead of the
rhythm that begins then. In any stretch of time it therefore fires at most `stretch / period + 1 + CATCH_UP_TICKS`.
"""

from __future__ import annotations

from collections import deque

CATCH_UP_TICKS = 2


class Pace:
    """Keep the rhythm of ticks, `period_s` seconds apart; the next is due at `due_s`."""

    def __init__(self, period_s: float, now_s: float) -> None:
        self.period_s = period_s
        self.due_s = now_s

    def restart(self, now_s: float) -> None:
        """Begin a new rhythm: the next tick is due now, and there is nothing to catch up with."""
        self.due_s = now_s

    def fired(self, now_s: float) -> None:
        """Move the due time on after a tick; lateness beyond `CATCH_UP_TICKS` periods is forgiven."""
        self.due_s = max(self.due_s, now_s - CATCH_UP_TICKS * self.period_s) + self.period_s


class RealTimeFactor:
    """Measure simulated over wall time, from tick to tick, during about the last `window_s` seconds."""

    def __init__(self, period_s: float, now_s: float, window_s: float = 2.0) -> None:
        self._period_s = period_s
        self._window_s = window_s
        self._ticks_s: deque[float] = deque()
        self.restart(now_s)

    def restart(self, now_s: float) -> None:
        """Forget what was: the world begins anew, its first tick is due now."""
        self._ticks_s.clear()
        self._ticks_s.append(now_s - self._period_s)

    def ticked(self, now_s: float) -> None:
        """Note that a tick has fired."""
        self._ticks_s.append(now_s)

    def value(self, now_s: float) -> float:
        """Return the factor; 1.0 until two periods have passed, before which there is nothing to tell."""
        until_s = max(self._ticks_s[-1], now_s - self._period_s)  # a tick that is not due yet is not missing
        while len(self._ticks_s) > 1 and self._ticks_s[1] <= until_s - self._window_s:
            self._ticks_s.popleft()
        elapsed_s = until_s - self._ticks_s[0]
        if elapsed_s < 2 * self._period_s:
            return 1.0
        return (len(self._ticks_s) - 1) * self._period_s / elapsed_s
