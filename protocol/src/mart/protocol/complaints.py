"""A log that a flood of bad messages cannot flood."""

from __future__ import annotations

import logging
from collections import Counter

_log = logging.getLogger(__name__)

_PERIOD_S = 1.0


class Complaints:
    """Says in the log what was not used, one line a second at most."""

    def __init__(self) -> None:
        self._said: Counter[str] = Counter()
        self._due_s = 0.0

    def say(self, counted: Counter[str], now_s: float) -> None:
        """`counted`: how often each reason occurred since the start."""
        if counted == self._said or now_s < self._due_s:
            return
        news = counted - self._said
        _log.warning(
            "Not used: %s", ", ".join(f"{count} x {reason}" for reason, count in sorted(news.items()))
        )
        self._said, self._due_s = counted.copy(), now_s + _PERIOD_S
