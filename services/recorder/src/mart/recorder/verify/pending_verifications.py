"""Verify again what could not be verified when it was saved, until it is: on a thread of its own, one file at a time.

What is to be done stands in the files and labels, so nothing is forgotten over a restart: the recorder shows each
listing of its folder (`see`), at its start and after every save.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from pathlib import Path

from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.reader import EpisodeFile
from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.recorder.record.finalize import SavedEpisode, VerifyFile
from mart.recorder.record.recorder_metrics import VERIFICATIONS
from mart.recorder.verify.retry_schedule import RetrySchedule
from mart.recorder.verify.verdict_label import keep_verdict

_log = logging.getLogger(__name__)

_LOOK_EVERY_S = 10.0  # for a replica of which no word came

OnVerdict = Callable[[SavedEpisode], None]


class PendingVerifications:
    """Try pending files while a replica is up.

    is_up: whether a replica can be asked. on_verdict: is told of each verdict that was had, after it was labelled.
    list_again: lists the folder anew, when more were pending than are held at once.
    """

    def __init__(
        self,
        verify: VerifyFile,
        is_up: Callable[[], bool],
        on_verdict: OnVerdict,
        list_again: Callable[[], Iterable[LabelledEpisode]],
    ) -> None:
        self._verify, self._is_up, self._on_verdict = verify, is_up, on_verdict
        self._list_again = list_again
        self._schedule = RetrySchedule()
        self._lock = threading.Lock()
        self._changed = threading.Event()
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name="verifications", daemon=True)

    def start(self) -> None:
        """Begin to try."""
        self._thread.start()

    def close(self) -> None:
        """Stop, once the file that is being verified has its answer."""
        self._stopping = True
        self._changed.set()
        self._thread.join()

    def see(self, listed: Iterable[LabelledEpisode]) -> None:
        """Take in what is pending among listed episodes. For any thread."""
        with self._lock:
            for episode in listed:
                if episode.verification_pending:
                    self._schedule.add(episode.file_path, clock.monotonic_s())
            VERIFICATIONS.set(len(self._schedule))
        self._changed.set()

    def wake(self) -> None:
        """Try everything now: a replica has appeared. For any thread."""
        with self._lock:
            self._schedule.wake(clock.monotonic_s())
        self._changed.set()

    def _run(self) -> None:
        while not self._stopping:
            self._changed.clear()
            path = self._next()
            if path is None:
                self._changed.wait(self._left_s())
            elif self._is_up():
                self._try(path)
            else:
                self._changed.wait(_LOOK_EVERY_S)

    def _next(self) -> Path | None:
        with self._lock:
            is_drained = self._schedule.is_short and not len(self._schedule)
            self._schedule.is_short = self._schedule.is_short and not is_drained
        if is_drained:
            self.see(self._list_again())
        with self._lock:
            return self._schedule.next_due(clock.monotonic_s())

    def _left_s(self) -> float | None:
        with self._lock:
            due_s = self._schedule.due_s()
        return None if due_s is None else max(due_s - clock.monotonic_s(), 0.0)

    def _try(self, path: Path) -> None:
        """Verify one file. Whatever goes wrong over it, the others go on."""
        try:
            has_verdict = self._judge(path)
        except MartError as error:  # it is damaged, or was moved away
            _log.warning("%s is not verified: %s", path, error)
            has_verdict = True
        except Exception:  # noqa: BLE001 - logged whole; one file must not keep the others from their verdicts
            _log.exception("%s could not be verified; it is tried again later", path)
            has_verdict = False
        with self._lock:
            if has_verdict:
                self._schedule.drop(path)
            else:
                self._schedule.put_off(path, clock.monotonic_s())
            VERIFICATIONS.set(len(self._schedule))

    def _judge(self, path: Path) -> bool:
        file = EpisodeFile.open(path)
        said = self._verify(file, file.room)
        if said.pending:
            _log.info("%s is not verified yet: %s", path, said.detail)
            return False
        keep_verdict(path, said, clock.wall_ns())
        self._on_verdict(SavedEpisode(path, file.episode, file.cadence, said, path.stat().st_size))
        return True
