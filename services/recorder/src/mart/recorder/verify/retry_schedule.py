"""Say which unverified file is tried next, and when. Pure; times are monotonic seconds.

A file whose verification could not be had waits twice as long each time, up to ten minutes; all are due at once when a
replica appears. What is one too many is left out, and found again in the folder once there is room.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

FIRST_DELAY_S = 2.0
LONGEST_DELAY_S = 600.0
MAX_WAITING = 1000


@dataclass
class _Wait:
    due_s: float
    attempts: int = 0


class RetrySchedule:
    """Hold up to `most` files that are to be verified. is_short: whether some had to be left out."""

    def __init__(self, most: int = MAX_WAITING) -> None:
        self._most = most
        self._waits: dict[Path, _Wait] = {}
        self.is_short = False

    def __len__(self) -> int:
        return len(self._waits)

    def add(self, path: Path, now_s: float) -> None:
        """Take in a file, due now; one that is known waits on as it does."""
        if path in self._waits:
            return
        if len(self._waits) >= self._most:
            self.is_short = True
            return
        self._waits[path] = _Wait(now_s)

    def next_due(self, now_s: float) -> Path | None:
        """Return the file that has been due for longest; None where none is."""
        due = [(wait.due_s, path) for path, wait in self._waits.items() if wait.due_s <= now_s]
        return min(due)[1] if due else None

    def due_s(self) -> float | None:
        """Return when the next file is due; None without any."""
        return min((wait.due_s for wait in self._waits.values()), default=None)

    def put_off(self, path: Path, now_s: float) -> None:
        """Try this file again later, the later the more often it was tried."""
        wait = self._waits.get(path)
        if wait is not None:
            delay_s = min(FIRST_DELAY_S * 2.0 ** min(wait.attempts, 32), LONGEST_DELAY_S)
            wait.attempts, wait.due_s = wait.attempts + 1, now_s + delay_s

    def drop(self, path: Path) -> None:
        """Forget a file: it has its verdict, or is gone."""
        self._waits.pop(path, None)

    def wake(self, now_s: float) -> None:
        """Make every file due now."""
        for wait in self._waits.values():
            wait.due_s, wait.attempts = min(wait.due_s, now_s), 0
