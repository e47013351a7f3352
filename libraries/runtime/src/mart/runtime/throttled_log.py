"""Log what was not used without letting a flood of bad messages flood the log."""

from __future__ import annotations

import logging
from collections import Counter

_PERIOD_S = 1.0


class ThrottledLog:
    """Log how often each reason occurred, one line a second at most."""

    def __init__(self, logger: logging.Logger) -> None:
        self._logger = logger
        self._logged: Counter[str] = Counter()
        self._due_s = 0.0

    def report(self, counts: Counter[str], now_s: float) -> None:
        """Log what `counts`, the number of times since the start by reason, has more than when last logged."""
        if counts == self._logged or now_s < self._due_s:
            return
        news = counts - self._logged
        self._logger.warning(
            "Not used: %s", ", ".join(f"{count} x {reason}" for reason, count in sorted(news.items()))
        )
        self._logged, self._due_s = counts.copy(), now_s + _PERIOD_S
