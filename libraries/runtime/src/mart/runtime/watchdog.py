"""End a process that has stopped doing what it is there for, so that its supervisor starts the next one.

A process whose threads wait for each other keeps its liveliness token, and everybody waits for it for ever.
"""

from __future__ import annotations

import faulthandler
import logging
import os
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self

_log = logging.getLogger(__name__)

_EXIT_STATUS = 70  # EX_SOFTWARE of sysexits.h


class Watchdog:
    """Look every `look_every_s` whether `feed` was called since; after `most_misses` looks in a row without, `end`.

    Looks are counted, not seconds: a process that was frozen, and its watchdog with it, has missed none. Open while the
    `with` block runs.
    """

    def __init__(
        self,
        what: str,
        most_misses: int = 15,
        look_every_s: float = 1.0,
        end: Callable[[str], None] | None = None,
    ) -> None:
        self._what, self._most_misses, self._look_every_s = what, most_misses, look_every_s
        self._end = end or end_process
        self._fed = True
        self._misses = 0
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="watchdog", daemon=True)

    def feed(self) -> None:
        """Say that all is well. For any thread."""
        self._fed = True

    def look(self) -> bool:
        """Return whether it is time to end."""
        self._misses = 0 if self._fed else self._misses + 1
        self._fed = False
        return self._misses >= self._most_misses

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._closing.set()

    def _run(self) -> None:
        while not self._closing.wait(self._look_every_s):
            if self.look():
                stood_s = self._most_misses * self._look_every_s
                self._end(f"{self._what} has done nothing for {stood_s:g} s")
                return


def end_process(why: str) -> None:
    """Say why, with what every thread is doing, and end this process at once: nothing in it can be relied on."""
    _log.critical("This process ends: %s. What its threads do:", why)
    faulthandler.dump_traceback(all_threads=True)
    os._exit(_EXIT_STATUS)


def start_vital_thread(
    target: Callable[[], None], name: str, end: Callable[[str], None] = end_process
) -> threading.Thread:
    """Start a daemon thread without which the process is of no use: where it fails, the process ends.

    So its supervisor and its liveliness token tell the truth.
    """

    def run() -> None:
        try:
            target()
        except Exception as error:  # noqa: BLE001 - logged whole, and the process ends
            _log.exception("The thread %s failed", name)
            end(f"its thread {name} failed ({type(error).__name__})")

    thread = threading.Thread(target=run, name=name, daemon=True)
    thread.start()
    return thread
