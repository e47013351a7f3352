"""Bound how often something may happen. Pure: the time is an argument."""

from __future__ import annotations

from collections import OrderedDict, deque

_MAX_KEYS = 4096


class RateLimit:
    """Allow at most `count` times in any `window_s` seconds; what is refused does not count."""

    def __init__(self, count: int, window_s: float = 1.0) -> None:
        self._times_s: deque[float] = deque(maxlen=count)
        self._window_s = window_s

    def wait_s(self, now_s: float) -> float:
        """Return the seconds until the next one is allowed; 0 where it is allowed now."""
        if len(self._times_s) < (self._times_s.maxlen or 0):
            return 0.0
        return max(0.0, self._window_s - (now_s - self._times_s[0]))

    def count(self, now_s: float) -> None:
        """Note one, allowed or not."""
        self._times_s.append(now_s)

    def allows(self, now_s: float) -> bool:
        """Tell whether one is allowed now, and note it where it is."""
        if self.wait_s(now_s) > 0.0:
            return False
        self.count(now_s)
        return True


class KeyedRateLimit:
    """Hold one `RateLimit` a key (an address, a person), for the 4096 keys that were used last: memory is bounded."""

    def __init__(self, count: int, window_s: float) -> None:
        self._count = count
        self._window_s = window_s
        self._limits: OrderedDict[str, RateLimit] = OrderedDict()

    def wait_s(self, key: str, now_s: float) -> float:
        """Return the seconds until `key` is allowed its next one; 0 where that is now. Counts nothing."""
        limit = self._limits.get(key)
        return limit.wait_s(now_s) if limit is not None else 0.0

    def count(self, key: str, now_s: float) -> None:
        """Note one of `key`."""
        self._limits.setdefault(key, RateLimit(self._count, self._window_s)).count(now_s)
        self._limits.move_to_end(key)
        if len(self._limits) > _MAX_KEYS:
            self._limits.popitem(last=False)
