"""Measure the episodes of a folder while nobody has to wait: in a thread, one at a time, the newest first.

Whoever asks is answered at once with what is known by then, and how much that is.
"""

from __future__ import annotations

import logging
import sqlite3
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from operator import is_

from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality.comparison import JudgedEpisode, judge
from mart.episodes.quality.store import MeasuredQuality, measure_all
from mart.protocol import clock

_log = logging.getLogger(__name__)

_PUBLISH_S = 2.0  # judging all of thousands takes a while
_PAUSE_S = 2.0  # between two looks at a folder that somebody browses


@dataclass(frozen=True)
class KnownQuality:
    """Hold what is known now, by path: episodes that were measured and judged, and why others could not be."""

    judged: Mapping[str, JudgedEpisode] = field(default_factory=dict)
    errors: Mapping[str, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.judged) + len(self.errors)


class QualityMeasurer:
    """Measure what is listed. `see` and `known` are for any thread; nothing happens before `start`."""

    def __init__(self) -> None:
        self.known = KnownQuality()
        self._wanted: Sequence[LabelledEpisode] = ()
        self._measured: dict[str, tuple[LabelledEpisode, MeasuredQuality]] = {}
        self._news = threading.Event()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Begin to measure in the background."""
        self._thread = threading.Thread(target=self._run, name="quality", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End it; what was measured is on the disk."""
        self._stop.set()
        self._news.set()
        if self._thread is not None:
            self._thread.join()

    def see(self, rows: Sequence[LabelledEpisode]) -> None:
        """Take which episodes there are now, the oldest first."""
        if len(rows) != len(self._wanted) or not all(map(is_, rows, self._wanted)):
            self._wanted = rows
            self._news.set()

    def measure_wanted(self) -> None:
        """Measure what has been seen and is not known yet; what is known by then is told every two seconds."""
        rows = [row for row in reversed(self._wanted) if row.error is None]
        kept = {
            row.path: self._measured[row.path]
            for row in rows
            if row.path in self._measured and self._measured[row.path][0] == row
        }
        changed = kept.keys() != self._measured.keys()
        self._measured, told_s = kept, clock.monotonic_s()
        for row, found in measure_all(self._unless_stopped([row for row in rows if row.path not in kept])):
            self._measured[row.path] = row, found
            changed = True
            if clock.monotonic_s() - told_s >= _PUBLISH_S:
                self._publish()
                told_s = clock.monotonic_s()
        if changed:
            self._publish()

    def _unless_stopped(self, rows: Sequence[LabelledEpisode]) -> Iterator[LabelledEpisode]:
        for row in rows:
            if self._stop.is_set():
                return
            yield row

    def _publish(self) -> None:
        found = self._measured.values()
        judged = judge((row, one.quality) for row, one in found if one.quality is not None)
        self.known = KnownQuality(
            {one.episode.path: one for one in judged},
            {row.path: one.error for row, one in found if one.quality is None},
        )

    def _run(self) -> None:
        while not self._stop.is_set():
            self._news.wait()
            self._news.clear()
            try:
                self.measure_wanted()
            except (OSError, sqlite3.Error) as error:  # the next look makes up for it
                self._wanted = ()
                _log.warning("The quality of episodes could not be measured: %s", error)
            self._stop.wait(_PAUSE_S)
