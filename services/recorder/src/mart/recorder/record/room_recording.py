"""Record one room: its tracker decides what belongs into which file, and here it is done."""

from __future__ import annotations

import copy
import logging
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mart.episodes.patient_file import is_for_want_of_room
from mart.episodes.steady_time import SteadyTime
from mart.episodes.writer import EpisodeWriter
from mart.protocol import keys
from mart.protocol.errors import MartError
from mart.protocol.messages import Command, Event, RoomStatus, State
from mart.protocol.tasks import tasks_folder
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.arrival_decoder import ArrivedMessage, decode_arrival
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.finalize import describe_room, is_saved, part_path
from mart.recorder.record.finalize_worker import FinalizeWorker, in_words
from mart.recorder.record.folder_watch import FolderWatch
from mart.recorder.record.inbox import BusArrival
from mart.recorder.record.room_claim import RoomClaim
from mart.recorder.record.room_facts import RoomFacts
from mart.recorder.record.room_models import RoomModels
from mart.recorder.record.room_tracker import CloseFile, FileAction, OpenFile, RoomTracker
from mart.runtime.rate_limit import RateLimit

_log = logging.getLogger(__name__)

FLUSH_S = 0.5
_REPORT_S = 0.1
_TELL_AGAIN_S = 60.0
_LOW_SPACE_BYTES = 1_000_000_000


@dataclass(frozen=True)
class RecordingTools:
    """Hold what every room's recording uses. root: the folder of the episodes."""

    root: Path
    models: RoomModels
    announcer: Announcer
    finalizer: FinalizeWorker


class RoomRecording:
    """Write the episodes of one room, one file after another. A broken disk ends the file at hand, never the room."""

    def __init__(self, room: str, tools: RecordingTools, claim: RoomClaim) -> None:
        """Record a room that is claimed; whoever leaves the room releases `claim`."""
        self.claim = claim
        self._files: dict[EpisodeAccumulator, EpisodeWriter] = {}
        self._facts: dict[EpisodeAccumulator, RoomFacts] = {}  # of the run of the sim in which it is recorded
        self.heard_s = 0.0
        self._room = room
        self._tools = tools
        self._tracker = RoomTracker(room, self._is_saved)
        self._boot = 0
        self._flushed_s = self._reported_s = 0.0
        self._tellings = RateLimit(1, _TELL_AGAIN_S)
        self._folder_watch = FolderWatch(tools.root)
        self._arrivals, self._newest_ns = SteadyTime(), 0

    @property
    def is_writing(self) -> bool:
        """Whether a file is open."""
        return bool(self._files)

    def take(self, arrival: BusArrival, now_s: float) -> None:
        """Write what has arrived, if it belongs into a file. Raises InvalidInput for what cannot be used."""
        self.heard_s = now_s
        steady = replace(arrival, arrived_ns=self._steady_ns(arrival.arrived_ns, now_s))
        self._apply(self._decide(decode_arrival(arrival), steady, now_s))

    def _steady_ns(self, arrived_ns: int, now_s: float) -> int:
        """Return when something came: never before what came before it into an open file, whatever the clock does."""
        if not self._files:
            self._arrivals, self._newest_ns = (
                SteadyTime(),
                0,
            )  # a clock that was set right is right from here on
        steady_ns = self._arrivals.steady_ns(arrived_ns, round(now_s * 1e9))
        self._newest_ns = max(self._newest_ns, steady_ns)
        return self._newest_ns

    def advance(self, now_s: float) -> None:
        """Do what it is time for: close a file that is over, bring an open one onto the disk."""
        self._apply(self._tracker.advance(now_s))
        if self._files and now_s - self._flushed_s >= FLUSH_S:
            self._flush(now_s)
        if self._files and now_s - self._reported_s >= _REPORT_S:
            self._reported_s = now_s
            self._report()
        if self._tracker.unknown_task and self._tellings.allows(now_s):
            text = (
                f"The recorder does not know the task {self._tracker.unknown_task[:64]!r}: nothing is recorded here. "
                f"Of a task of your own, put the file into {tasks_folder()} beside the recorder."
            )
            self._tools.announcer.notice(self._room, "error", text)

    def _report(self) -> None:
        """Tell the room what is kept, or what keeps it from being kept."""
        if (news := self._folder_watch.news()) is not None:
            self._tools.announcer.notice(self._room, *news)
        episode = self._tracker.episode
        if episode in self._files and not self._files[episode].waits:
            self._tools.announcer.report(episode.room, episode.boot, episode.number, episode.last_tick)

    def _flush(self, now_s: float) -> None:
        """Bring the open files onto the disk, with what is known about the room by now."""
        self._flushed_s = now_s
        for episode, file in list(self._files.items()):
            try:
                file.require_there()
                describe_room(file, self._facts[episode], self._tools.models.known(self._room, episode.boot))
                file.flush()
            except Exception as error:  # noqa: BLE001 - as above
                if not (file.waits and is_for_want_of_room(error)):
                    self._give_up(episode, error)

    def finish(self, reason: str) -> None:
        """End what is being recorded; the file says why it was not finished."""
        self._apply(self._tracker.finish(reason))

    def count_losses(self, messages: int, frames: int, text: str) -> None:
        """Note in the open file what the recorder could not keep up with, and tell the room in these words."""
        self._tracker.lost(messages, frames)
        if self._files:
            self._tools.announcer.notice(self._room, "error" if messages else "warning", text)

    def _decide(self, message: ArrivedMessage, arrival: BusArrival, now_s: float) -> Sequence[FileAction]:
        payload, arrived_ns = arrival.payload, arrival.arrived_ns
        match message:
            case State():
                self._notice_boot(message.boot)
                return self._tracker.state(message, payload, arrived_ns, now_s)
            case RoomStatus():
                self._notice_boot(message.boot)
                return self._tracker.status(message, now_s)
            case Event():
                return self._tracker.event(message, payload, arrived_ns, now_s)
            case Command():
                return self._tracker.command(keys.arm_of(arrival.key), message, payload, arrived_ns, now_s)
            case _:
                return self._tracker.video(keys.camera_of(arrival.key), message, payload, arrived_ns)

    def _is_saved(self, state: State) -> bool:
        try:
            return is_saved(self._tools.root, state.room, state.episode, state.stamps.sent_ns)
        except (OSError, MartError) as error:  # a second file of it is better than none
            _log.warning(
                "Whether episode %d of %s is saved is not known: %s", state.episode, state.room, error
            )
            return False

    def _notice_boot(self, boot: int) -> None:
        if self._boot != boot:
            if self._boot:  # what is known of the last run stays with its files
                self._tracker.facts = self._tracker.facts.of_next_run()
            self._boot = boot
            self._tools.finalizer.fetch_model(self._room, boot)

    def _apply(self, actions: Iterable[FileAction]) -> None:
        for action in actions:
            try:
                self._act(action)
            except Exception as error:  # noqa: BLE001 - told, whatever it is; other episodes go on
                self._give_up(action.episode, error)

    def _act(self, action: FileAction) -> None:
        if isinstance(action, OpenFile):
            self._open(action.episode)
        elif isinstance(action, CloseFile):
            self._close(action.episode)
        elif action.episode in self._files:
            self._files[action.episode].add(action.entry)

    def _open(self, episode: EpisodeAccumulator) -> None:
        file = EpisodeWriter(part_path(self._tools.root, episode, self._tracker.facts))
        self._files[episode], self._facts[episode] = file, self._tracker.facts
        self._flushed_s = float("-inf")  # the first state is on the disk at once
        about = {"room": episode.room, "episode": episode.number}
        _log.info("%s: recording episode %d into %s", episode.room, episode.number, file.path, extra=about)
        if self._tools.models.known(self._room, episode.boot) is None:
            self._tools.finalizer.fetch_model(self._room, episode.boot)  # the first answer may have been lost
        free = shutil.disk_usage(self._tools.root).free
        if free < _LOW_SPACE_BYTES:
            text = f"The recorder's disk has {free / 1e6:.0f} MB left; make room before it is full."
            self._tools.announcer.notice(episode.room, "warning", text)

    def _close(self, episode: EpisodeAccumulator) -> None:
        file = self._files.pop(episode, None)
        facts = self._facts.pop(episode, None)
        if file is None or facts is None:
            return
        if episode.is_glimpse:
            file.discard()
        else:
            self._tools.finalizer.finalize(file, episode, copy.deepcopy(facts))

    def _give_up(self, episode: EpisodeAccumulator, error: Exception) -> None:
        """Leave this episode: the disk is broken, or was full for too long. The room and its next episode go on."""
        if not isinstance(error, OSError):
            _log.error("Recording episode %d failed", episode.number, exc_info=error)
        self._tracker.abandon(episode)
        self._facts.pop(episode, None)
        file = self._files.pop(episode, None)
        if file is not None:
            file.abandon()
        kept = file is not None and file.path.exists()
        where = f" What was written until now is in {file.path}." if file is not None and kept else ""
        text = f"Recording of episode {episode.number} stopped: {in_words(error)}.{where} The next one is tried again."
        self._tools.announcer.notice(self._room, "error", text)
