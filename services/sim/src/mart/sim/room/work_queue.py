"""Work that waits for whoever may do it."""

from __future__ import annotations

import queue
from collections.abc import Callable

_KEPT = 1024


class WorkQueue:
    """In the order in which it came. A flood beyond its bound is lost, not kept."""

    def __init__(self) -> None:
        self._queue: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()

    def put(self, work: Callable[[], None]) -> None:
        if self._queue.qsize() < _KEPT:
            self._queue.put(work)

    @property
    def is_empty(self) -> bool:
        return self._queue.empty()

    def work(self, timeout_s: float) -> None:
        """Waits until something is there, at most `timeout_s`, and does all that came until then."""
        if self.work_once(timeout_s):
            for _ in range(self._queue.qsize()):
                self.work_once(0.0)

    def work_once(self, timeout_s: float) -> bool:
        """Waits in the same way and does what came first; whether there was anything."""
        try:
            work = self._queue.get(timeout=max(timeout_s, 0.0))
        except queue.Empty:
            return False
        work()
        return True
