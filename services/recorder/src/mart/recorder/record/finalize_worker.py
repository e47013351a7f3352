"""Do what takes its time on threads of its own: complete files (re-simulated first), fetch models, repair."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from mart.episodes.writer import EpisodeWriter
from mart.protocol.errors import MartError
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import SavedEpisode, VerifyFile, describe_room, finalize
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.record.room_models import RoomModels

_log = logging.getLogger(__name__)


# Repairs what crashes have left and brings the catalogue up to date; yields what became an episode.
TidyFolder = Callable[[], Iterable[SavedEpisode]]


class FinalizeWorker:
    """Complete episode files in the background. Files given to `finalize` are its own from then on."""

    def __init__(
        self, root: Path, models: RoomModels, announcer: Announcer, verify: VerifyFile, tidy: TidyFolder
    ) -> None:
        self._root = root
        self._models = models
        self._announcer = announcer
        self._verify = verify
        self._tidy_folder = tidy
        self._unsaved = 0
        self._lock = threading.Lock()
        self._workers = ThreadPoolExecutor(max_workers=2, thread_name_prefix="finalize")

    def fetch_model(self, room: str, boot: int) -> None:
        """Ask for the room's model, so that it is known when an episode begins."""
        self._work("Fetching a model", self._models.fetch, room, boot)

    def finalize(self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts) -> None:
        """Verify a file, complete it, give it its name, and tell the room."""
        with self._lock:
            self._unsaved += 1
        self._work("Completing a file", self._finalize_counted, file, episode, facts)

    def tidy(self) -> None:
        """Make episodes of what an earlier run has left."""
        self._work("Tidying the folder", self._tidy)

    def close(self) -> None:
        """Wait until everything is done."""
        self._workers.shutdown(wait=True)

    def _finalize_counted(self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts) -> None:
        """Complete a file; once none waits, look through the folder, which takes longer the more is in it."""
        try:
            saved = self._finalize(file, episode, facts)
        finally:
            with self._lock:
                self._unsaved -= 1
        if saved and not self._unsaved:
            self._tidy()  # what a full disk had left, now that there may be room

    def _finalize(self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts) -> bool:
        try:
            describe_room(file, facts, self._models.fetch(episode.room, episode.boot))
            saved = finalize(file, episode, facts, self._root, self._verify, repaired=False)
        except (OSError, MartError) as error:
            file.abandon()
            why = error.strerror if isinstance(error, OSError) else error
            text = f"Episode {episode.number} could not be completed: {why}. It is kept as {file.path}."
            self._announcer.notice(episode.room, "error", text)
            return False
        self._announcer.saved(saved)
        return True

    def _tidy(self) -> None:
        for saved in self._tidy_folder():
            self._announcer.saved(saved)

    def _work(self, what: str, call: Callable[..., object], *arguments: object) -> None:
        def report(done: Future[object]) -> None:
            error = done.exception()
            if error is not None:
                _log.error("%s failed", what, exc_info=error)

        self._workers.submit(call, *arguments).add_done_callback(report)
