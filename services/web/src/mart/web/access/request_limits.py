"""How often someone may ask for something: a limit whose end is told in words."""

from __future__ import annotations

import math

from mart.runtime.rate_limit import KeyedRateLimit
from mart.web.errors import TooMany


class RequestLimit:
    """A limit of `count` times in any `window_s` seconds, for each key (an address, a user). Times are monotonic.

    `what` names it in words ("wrong codes").
    """

    def __init__(self, what: str, count: int, window_s: float) -> None:
        self._what = what
        self._limit = KeyedRateLimit(count, window_s)

    def check(self, key: str, now_s: float) -> None:
        """Count nothing; raises TooMany where `key` has used up its share."""
        wait_s = self._limit.wait_s(key, now_s)
        if wait_s > 0.0:
            raise TooMany(self._what, math.ceil(wait_s))

    def count(self, key: str, now_s: float) -> None:
        """Note one of `key`."""
        self._limit.count(key, now_s)

    def forgive(self, key: str) -> None:
        """Allow `key` its full share again."""
        self._limit.forget(key)

    def spend(self, key: str, now_s: float) -> None:
        """Note one of `key`; raises TooMany, without noting it, where its share is used up."""
        self.check(key, now_s)
        self.count(key, now_s)
