"""Keep the episodes of a folder in memory and up to date: read on a thread of its own, so that no request waits for it.

Who asks waits for a moment, in which a folder that is known is looked through; what takes longer goes on while the
rows so far are answered.
"""

from __future__ import annotations

import gc
import logging
import threading
from contextlib import closing
from pathlib import Path

from mart.episodes import labels
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.labels import EpisodeLabels
from mart.protocol import clock
from mart.recorder.catalogue.episode_catalogue import EpisodeCatalogue, Parsed, by_catalogue

_log = logging.getLogger(__name__)

_FRESH_S = 1.0
_PATIENCE_S = 0.1  # of a request for what changed in a folder that is known
_FIRST_PATIENCE_S = 5.0  # while nothing is known, or something is asked for that is not
_PROGRESS_S = 5.0


class LiveListing:
    """List the episodes under `root` with their labels, oldest first. For one thread besides its own."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._parsed: Parsed = {}
        self._bare: list[LabelledEpisode] = []  # without labels; replaced, never changed
        self._laid_over: dict[str, tuple[LabelledEpisode, EpisodeLabels | None, LabelledEpisode]] = {}
        self._reading: threading.Thread | None = None
        self._read_s = float("-inf")
        self._is_known = False
        self._progress: tuple[int, int] | None = None  # only ever replaced

    @property
    def progress(self) -> tuple[int, int] | None:
        """How many new or changed files are read of how many; None where all are, or nobody knows yet."""
        return self._progress

    def rows(self, *, anew: bool = False) -> dict[str, LabelledEpisode]:
        """Return every episode by its path, with its labels of now; anew: look into the folder whenever it was last.

        Raises Corrupt where the labels cannot be read.
        """
        if not self._root.is_dir():
            return {}
        self._follow(anew)
        said = labels.read_folded(self._root)
        laid_over = {}
        for bare in self._bare:
            of_now, before = said.get(bare.path), self._laid_over.get(bare.path)
            if before is None or before[0] is not bare or before[1] is not of_now:
                before = (bare, of_now, bare.with_labels(of_now))
            laid_over[bare.path] = before
        self._laid_over = laid_over
        return {path: row for path, (_, _, row) in laid_over.items()}

    def close(self) -> None:
        """Wait until nothing is read any more."""
        if self._reading is not None:
            self._reading.join(_FIRST_PATIENCE_S)

    def _follow(self, anew: bool) -> None:
        reading = self._reading
        if reading is not None and reading.is_alive():
            reading.join(_FIRST_PATIENCE_S if anew else _PATIENCE_S)
            if reading.is_alive() or not anew:
                return
        if anew or clock.monotonic_s() - self._read_s >= _FRESH_S:
            self._read_s = clock.monotonic_s()
            self._reading = threading.Thread(target=self._read, name="catalogue", daemon=True)
            self._reading.start()
            self._reading.join(_FIRST_PATIENCE_S if anew or not self._is_known else _PATIENCE_S)

    def _read(self) -> None:
        try:
            by_catalogue(self._root, self._read_by)
            if not self._is_known:
                gc.freeze()  # rows stay: without it the collector goes through all of them, in the middle of requests
            self._is_known = True
        except Exception:  # noqa: BLE001 - logged whole; the next request tries again
            _log.exception("%s could not be listed; what was known of it is answered", self._root)
        finally:
            self._progress = None

    def _read_by(self, database: Path | str) -> None:
        told_s = clock.monotonic_s()
        with closing(EpisodeCatalogue(self._root, database, self._parsed)) as catalogue:

            def after_some(done: int, of: int) -> None:
                nonlocal told_s
                self._progress = (done, of) if done < of else None
                if not self._is_known:
                    self._bare = catalogue.rows()
                if clock.monotonic_s() - told_s >= _PROGRESS_S:
                    told_s = clock.monotonic_s()
                    _log.info("%s: %d of %d new or changed episodes are read", self._root, done, of)

            catalogue.refresh(after_some)
            self._bare = catalogue.rows()
