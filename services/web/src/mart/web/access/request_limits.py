"""How often someone may ask for something: a limit whose end is told in words."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections import Counter, OrderedDict, deque
from collections.abc import AsyncIterator, Iterator

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

    def spend(self, key: str, now_s: float) -> None:
        """Note one of `key`; raises TooMany, without noting it, where its share is used up."""
        self.check(key, now_s)
        self.count(key, now_s)


class AtOnceLimit:
    """A limit of how many things of one key (a user) go on at one time. `what` names them in words."""

    def __init__(self, what: str, count: int) -> None:
        self._what, self._count = what, count
        self._held: Counter[str] = Counter()

    @contextlib.contextmanager
    def hold(self, key: str) -> Iterator[None]:
        """Count one of `key` as long as the block runs; raises TooMany where its share is used up."""
        if self._held[key] >= self._count:
            raise TooMany(self._what, 1.0)
        self._held[key] += 1
        try:
            yield
        finally:
            self._held[key] -= 1
            if not self._held[key]:
                del self._held[key]


class TurnLimit:
    """Let `count` things of one key (a user) go on at one time; the next waits for its turn. On an event loop."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._turns: dict[str, asyncio.Semaphore] = {}
        self._using: Counter[str] = Counter()  # those whose turn it is, and those that wait

    @contextlib.asynccontextmanager
    async def turn(self, key: str) -> AsyncIterator[None]:
        """Wait for the turn of one of `key`, which lasts as long as the block runs."""
        turns = self._turns.setdefault(key, asyncio.Semaphore(self._count))
        self._using[key] += 1
        try:
            async with turns:
                yield
        finally:
            self._using[key] -= 1
            if not self._using[key]:
                del self._using[key], self._turns[key]


class FailureDelay:
    """How long an answer is held back after failures of the same key (an address). Times are monotonic.

    The first `free` failures in `window_s` cost nothing; each further one adds `step_s` to the answers that follow,
    up to `longest_s`. Nobody is refused, so a guesser behind the same address keeps nobody out.
    """

    MAX_KEYS = 4096

    def __init__(self, free: int, window_s: float, step_s: float, longest_s: float) -> None:
        self._free, self._window_s = free, window_s
        self._step_s, self._longest_s = step_s, longest_s
        self._remembered = free + math.ceil(longest_s / step_s)
        self._failures: OrderedDict[str, deque[float]] = OrderedDict()

    def delay_s(self, key: str, now_s: float) -> float:
        """Return for how long the next answer to `key` is to be held back."""
        recent = sum(now_s - at_s < self._window_s for at_s in self._failures.get(key, ()))
        return min(max(recent - self._free, 0) * self._step_s, self._longest_s)

    def count(self, key: str, now_s: float) -> None:
        """Note a failure of `key`."""
        self._failures.setdefault(key, deque(maxlen=self._remembered)).append(now_s)
        self._failures.move_to_end(key)
        if len(self._failures) > self.MAX_KEYS:
            self._failures.popitem(last=False)
