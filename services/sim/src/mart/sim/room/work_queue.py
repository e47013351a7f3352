"""Keep work that waits for whoever may do it."""

from __future__ import annotations

import queue
from collections.abc import Callable

_KEPT = 1024


class WorkQueue:
    """Keep work in the order in which it came. A flood beyond its bound is lost, not kept."""

    def __init__(self) -> None:
        self._queue: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()

    def put(self, work: Callable[[], None]) -> None:
        """Add work to the end. For any thread."""
        if self._queue.qsize() < _KEPT:
            self._queue.put(work)

    @property
    def is_empty(self) -> bool:
        """Whether nothing waits."""
        return self._queue.empty()

    def run_all(self, timeout_s: float) -> None:
        """Wait until something is there, at most `timeout_s`, and do all that came until then."""
        if self.run_one(timeout_s):
            for _ in range(self._queue.qsize()):
                self.run_one(0.0)

    def run_one(self, timeout_s: float) -> bool:
        """Wait until something is there, at most `timeout_s`, and do the first; return whether there was anything."""
        try:
            work = self._queue.get(timeout=max(timeout_s, 0.0))
        except queue.Empty:
            return False
        work()
        return True
