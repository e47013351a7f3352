"""What takes its time, on threads of its own: saving (which waits for re-simulation), fetching models, repairing."""

from __future__ import annotations

import logging
import sqlite3
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from mart.episodes.writer import EpisodeWriter
from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.protocol.messages import Model
from mart.recorder.catalogue.episode_catalogue import list_folder
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.episode_accumulator import EpisodeAccumulator, RoomFacts
from mart.recorder.record.finalize import Verify, finalize
from mart.recorder.record.room_models import RoomModels
from mart.recorder.repair.repair import log_repairs, repair_all

_log = logging.getLogger(__name__)


class FinalizeWorker:
    """Files given to `save` are its own from then on."""

    def __init__(self, root: Path, models: RoomModels, announcer: Announcer, verify: Verify) -> None:
        self._root = root
        self._models = models
        self._announcer = announcer
        self._verify = verify
        self._unsaved = 0
        self._lock = threading.Lock()
        self._workers = ThreadPoolExecutor(max_workers=2, thread_name_prefix="saver")

    def fetch_model(self, room: str, boot: int) -> None:
        """So that it is known when an episode begins."""
        self._work("Fetching a model", self._models.fetch, room, boot)

    def finalize(self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts) -> None:
        with self._lock:
            self._unsaved += 1
        self._work("Saving", self._save_counted, file, episode, facts)

    def repair(self) -> None:
        """Makes episodes of what an earlier run has left."""
        self._work("Repairing", self._repair)

    def close(self) -> None:
        """Waits until everything is done."""
        self._workers.shutdown(wait=True)

    def _save_counted(self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts) -> None:
        """The folder is looked through once nothing else waits: that takes longer the more is in it."""
        try:
            saved = self._save(file, episode, facts)
        finally:
            with self._lock:
                self._unsaved -= 1
        if saved and not self._unsaved:
            self._repair()  # what a full disk had left, now that there may be room

    def _save(self, file: EpisodeWriter, episode: EpisodeAccumulator, facts: RoomFacts) -> bool:
        try:
            describe(file, facts, self._models.fetch(episode.room, episode.boot))
            saved = finalize(file, episode, facts, self._root, self._verify, repaired=False)
        except (OSError, MartError) as error:
            file.abandon()
            why = error.strerror if isinstance(error, OSError) else error
            text = f"Episode {episode.number} could not be completed: {why}. It is kept as {file.path}."
            self._announcer.notice(episode.room, "error", text)
            return False
        self._announcer.saved(saved)
        return True

    def _repair(self) -> None:
        for saved in log_repairs(repair_all(self._root, self._verify)):
            self._announcer.saved(saved)
        try:
            list_folder(self._root)
        except (OSError, sqlite3.Error) as error:  # it is derived: the next one makes up for it
            _log.warning("The catalogue could not be brought up to date: %s", error)

    def _work(self, what: str, call: Callable[..., object], *arguments: object) -> None:
        def report(done: Future[object]) -> None:
            error = done.exception()
            if error is not None:
                _log.error("%s failed", what, exc_info=error)

        self._workers.submit(call, *arguments).add_done_callback(report)


def describe(file: EpisodeWriter, facts: RoomFacts, model: Model | None) -> None:
    """Writes what is known about the room, once it is known."""
    if model is not None and not file.has_model:
        facts.learn_model(model)
    if facts.is_complete and not file.described:
        file.describe(facts.record())
    if model is not None and not file.has_model and file.described:
        file.attach_model(model, clock.wall_ns())
