"""Do what takes its time on threads of its own: complete files (re-simulated first), fetch models, repair."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path

from mart.episodes.writer import EpisodeWriter
from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.protocol.messages import Model
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import SavedEpisode, VerifyFile, describe_room, finalize
from mart.recorder.record.pieces import drop_pieces
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.record.room_models import RoomModels

_log = logging.getLogger(__name__)

_MAX_FETCHERS = 64  # one a room: who does not answer keeps nobody waiting

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
        self._fetching: set[str] = set()
        self._lock = threading.Lock()
        self._workers = ThreadPoolExecutor(max_workers=2, thread_name_prefix="finalize")
        self._fetchers = ThreadPoolExecutor(max_workers=_MAX_FETCHERS, thread_name_prefix="model")

    @property
    def unsaved(self) -> int:
        """How many files it was given that are not complete yet."""
        return self._unsaved

    def fetch_model(self, room: str, boot: int) -> None:
        """Ask for the room's model, so that it is known when an episode begins; one question a room at a time."""
        with self._lock:
            if room in self._fetching:
                return
            self._fetching.add(room)
        self._work(self._fetchers, "Fetching a model", self._fetch, room, boot)

    def finalize(self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts) -> None:
        """Verify a file, complete it, give it its name, and tell the room. A model that lacks is awaited elsewhere."""
        with self._lock:
            self._unsaved += 1

        def go_on(model: Model | None) -> None:
            self._work(
                self._workers, "Completing a file", self._finalize_counted, file, episode, facts, model
            )

        known = self._models.known(episode.room, episode.boot)
        if known is not None:
            go_on(known)
        else:
            fetched = self._fetchers.submit(self._models.fetch, episode.room, episode.boot)
            fetched.add_done_callback(lambda done: go_on(None if done.exception() else done.result()))

    def tidy(self, wait_s: float = 0.0) -> None:
        """Make episodes of what an earlier run has left; wait for it at most `wait_s`."""
        wait([self._work(self._workers, "Tidying the folder", self._tidy)], wait_s)

    def close(self) -> None:
        """Wait until everything is done."""
        self._fetchers.shutdown(wait=True)
        self._workers.shutdown(wait=True)

    def _fetch(self, room: str, boot: int) -> None:
        try:
            self._models.fetch(room, boot)
        finally:
            with self._lock:
                self._fetching.discard(room)

    def _finalize_counted(
        self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts, model: Model | None
    ) -> None:
        """Complete a file; once none waits, look through the folder, which takes longer the more is in it."""
        try:
            saved = self._finalize(file, episode, facts, model)
        finally:
            with self._lock:
                self._unsaved -= 1
        if saved and not self._unsaved:
            self._tidy()  # what a full disk had left, now that there may be room

    def _finalize(
        self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts, model: Model | None
    ) -> bool:
        try:
            describe_room(file, facts, model)
            saved = finalize(file, episode, facts, self._root, self._verify, repaired=False)
        except Exception as error:  # noqa: BLE001 - told, whatever it is; the next file is completed all the same
            file.abandon()
            if not isinstance(error, OSError | MartError):
                _log.exception("Completing %s failed", file.path)
            kept = f"It is kept as {file.path}." if file.path.exists() else f"Its file {file.path} is gone."
            text = f"Episode {episode.number} could not be completed: {in_words(error)}. {kept}"
            self._announcer.notice(episode.room, "error", text)
            return False
        self._tell(saved)
        return True

    def _tidy(self) -> None:
        for saved in self._tidy_folder():
            self._tell(saved)

    def _tell(self, saved: SavedEpisode) -> None:
        self._announcer.saved(saved)
        try:
            dropped = drop_pieces(self._root, saved.episode.room, saved.episode.number, clock.wall_ns())
        except (OSError, MartError) as error:  # a full disk: the pieces stay, beside the whole
            _log.warning("The pieces of %s are not left out: %s", saved.path, error)
            return
        for piece in dropped:
            _log.info("%s is left out: the whole episode is in another file", piece)

    def _work(
        self, workers: ThreadPoolExecutor, what: str, call: Callable[..., object], *arguments: object
    ) -> Future[object]:
        def report(done: Future[object]) -> None:
            error = done.exception()
            if error is not None:
                _log.error("%s failed", what, exc_info=error)

        future = workers.submit(call, *arguments)
        future.add_done_callback(report)
        return future


def in_words(error: Exception) -> str:
    """Return what went wrong, for people: an unexpected error by its name."""
    if isinstance(error, OSError):
        return error.strerror or type(error).__name__
    if isinstance(error, MartError):
        return str(error).rstrip(".")
    return f"the recorder failed at it ({type(error).__name__}), and its log says how"
