"""How often someone may do something: pure, the time is an argument."""

from __future__ import annotations

import math
from collections import OrderedDict, deque

from mart.web.errors import TooMany

_MAX_REMEMBERED = 4096


class RateLimit:
    """At most `count` times in any `window_s` seconds, for each key (an address, a person). Bounded memory."""

    def __init__(self, what: str, count: int, window_s: float) -> None:
        self._what = what
        self._count = count
        self._window_s = window_s
        self._times: OrderedDict[str, deque[float]] = OrderedDict()

    def check(self, key: str, now_s: float) -> None:
        """Raises TooMany where `key` has used up its share; counts nothing."""
        times = self._times.get(key)
        if times is not None and len(times) == self._count and now_s - times[0] < self._window_s:
            raise TooMany(self._what, math.ceil(self._window_s - (now_s - times[0])))

    def count(self, key: str, now_s: float) -> None:
        self._times.setdefault(key, deque(maxlen=self._count)).append(now_s)
        self._times.move_to_end(key)
        if len(self._times) > _MAX_REMEMBERED:
            self._times.popitem(last=False)

    def forgive(self, key: str) -> None:
        self._times.pop(key, None)

    def spend(self, key: str, now_s: float) -> None:
        """Checks, then counts."""
        self.check(key, now_s)
        self.count(key, now_s)
