"""How many of something a second."""

from __future__ import annotations

from collections import deque


class RateLimit:
    """Allows at most `at_most` in any one second; what it refuses does not count."""

    def __init__(self, at_most: int) -> None:
        self._times_s: deque[float] = deque(maxlen=at_most)

    def allows(self, now_s: float) -> bool:
        full = len(self._times_s) == self._times_s.maxlen
        if full and now_s - self._times_s[0] < 1.0:
            return False
        self._times_s.append(now_s)
        return True
