"""The one place that reads clocks. Everything else takes `now` as an argument or calls these."""

from __future__ import annotations

import time


def wall_ns() -> int:
    """Unix time in nanoseconds: for stamps that leave the process."""
    return time.time_ns()


def monotonic_s() -> float:
    """Seconds on a clock that never steps: for durations and deadlines inside one process."""
    return time.monotonic()


def monotonic_ns() -> int:
    """Nanoseconds on the same clock as `monotonic_s`."""
    return time.monotonic_ns()


def sleep_s(duration_s: float) -> None:
    """Blocks this thread; pacing only, never to wait for an event."""
    if duration_s > 0:
        time.sleep(duration_s)


def thread_cpu_s() -> float:
    """Return the seconds for which the calling thread has been at work on a core, without what it waited for."""
    return time.thread_time()
