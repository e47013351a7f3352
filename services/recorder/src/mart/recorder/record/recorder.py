"""The recorder: what arrives for each room goes into the file of its episode; finished files are verified and named.

The caller's thread takes arrivals and writes; what takes longer is left to a `Saver`.
"""

from __future__ import annotations

import copy
import logging
import shutil
import threading
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from google.protobuf.message import Message

from mart.episodes.writer import EpisodeWriter
from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Command, Event, RoomStatus, State
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.episode_accumulator import EpisodeAccumulator, RoomFacts
from mart.recorder.record.finalize import Verify, part_path
from mart.recorder.record.finalize_worker import FinalizeWorker, describe
from mart.recorder.record.inbox import ArrivalKind, BusArrival, Inbox, InboxBatch
from mart.recorder.record.room_models import RoomModels
from mart.recorder.record.room_tracker import CloseFile, FileAction, OpenFile, RoomTracker
from mart.runtime.bus import Bus

M = TypeVar("M", bound=Message)

_log = logging.getLogger(__name__)

FLUSH_S = 0.5
_STEP_S = 0.05
_LOG_EVERY_S = 1.0
_MAX_ROOMS = 64
_LOW_SPACE_BYTES = 1_000_000_000
_LIMIT_BYTES = {
    ArrivalKind.STATE: 4 << 20,
    ArrivalKind.STATUS: 1 << 20,
    ArrivalKind.EVENT: 1 << 20,
    ArrivalKind.COMMAND: 64 << 10,
    ArrivalKind.VIDEO: 8 << 20,
}


@dataclass
class RoomRecording:
    """One room and the file of its episode, while there is one."""

    tracker: RoomTracker
    file: EpisodeWriter | None = None
    boot: int = 0
    flushed_s: float = 0.0

    @property
    def facts(self) -> RoomFacts:
        return self.tracker.facts


@dataclass
class ArrivalRejects:
    """Counts what cannot be used and says so once a second at most."""

    counts: Counter[ArrivalKind] = field(default_factory=Counter)
    said_s: float = float("-inf")

    def add(self, arrival: BusArrival, error: InvalidInput, now_s: float) -> None:
        self.counts[arrival.kind] += 1
        if now_s - self.said_s >= _LOG_EVERY_S:
            self.said_s = now_s
            what, count = arrival.kind.name.lower(), self.counts[arrival.kind]
            _log.warning("A %s on %s is ignored (%d so far): %s", what, arrival.key, count, error)


class Recorder:
    def __init__(self, data_dir: Path, bus: Bus, inbox: Inbox, verify: Verify) -> None:
        self._root = data_dir.resolve() / "episodes"
        self._inbox = inbox
        self._models = RoomModels(bus)
        self._announcer = Announcer(bus, data_dir.resolve())
        self._rooms: dict[str, RoomRecording] = {}
        self._rejects = ArrivalRejects()
        self._finalizer = FinalizeWorker(self._root, self._models, self._announcer, verify)

    def run(self, stop: threading.Event) -> None:
        """Records until told to stop, then saves what is open."""
        self._root.mkdir(parents=True, exist_ok=True)
        self._finalizer.repair()
        try:
            while not stop.is_set():
                self.step(_STEP_S)
        finally:
            self.close()

    def step(self, timeout_s: float) -> None:
        """Takes what has arrived, waiting `timeout_s` at most for something, and does what it is time for."""
        batch = self._inbox.take(timeout_s)
        now_s = clock.monotonic_s()
        self._report_losses(batch)
        for arrival in batch.arrivals:
            try:
                self._take(arrival, now_s)
            except InvalidInput as error:
                self._rejects.add(arrival, error, now_s)
        for room in self._rooms.values():
            self._apply(room, room.tracker.advance(now_s))
            if room.file is not None and now_s - room.flushed_s >= FLUSH_S:
                self._flush(room, now_s)

    def close(self) -> None:
        """Ends what is being recorded and waits until everything is saved."""
        for room in self._rooms.values():
            self._apply(room, room.tracker.finish("the recorder was stopped"))
        self._finalizer.close()

    def _take(self, arrival: BusArrival, now_s: float) -> None:
        """Raises InvalidInput for what cannot be used."""
        room = self._room(arrival.room)
        tracker, payload, arrived_ns = room.tracker, arrival.payload, arrival.arrived_ns
        actions: Iterable[FileAction]
        match arrival.kind:
            case ArrivalKind.STATE:
                state = _decode(State, arrival)
                self._seen(room, arrival.room, state.room, state.boot)
                actions = tracker.state(state, payload, arrived_ns, now_s)
            case ArrivalKind.STATUS:
                status = _decode(RoomStatus, arrival)
                self._seen(room, arrival.room, status.room, status.boot)
                actions = tracker.status(status, now_s)
            case ArrivalKind.EVENT:
                actions = tracker.event(_decode(Event, arrival), payload, arrived_ns, now_s)
            case ArrivalKind.COMMAND:
                arm = keys.arm_of(arrival.key)
                actions = tracker.command(arm, _decode(Command, arrival), payload, arrived_ns)
            case ArrivalKind.VIDEO:
                camera = keys.camera_of(arrival.key)
                actions = tracker.video(camera, _decode(CompressedVideo, arrival), payload, arrived_ns)
        self._apply(room, actions)

    def _room(self, name: str) -> RoomRecording:
        if name not in self._rooms:
            keys.state(name)  # raises InvalidInput for a name that no room can have
            if len(self._rooms) >= _MAX_ROOMS:
                raise InvalidInput(f"Room {name!r} is one too many; at most {_MAX_ROOMS} are recorded.")
            self._rooms[name] = RoomRecording(RoomTracker(name))
        return self._rooms[name]

    def _seen(self, room: RoomRecording, name: str, said: str, boot: int) -> None:
        if said != name:
            raise InvalidInput(f"A message of room {said[:64]!r} was sent under the key of {name!r}.")
        if room.boot != boot:
            room.boot = boot
            self._finalizer.fetch_model(name, boot)

    def _apply(self, room: RoomRecording, actions: Iterable[FileAction]) -> None:
        for action in actions:
            try:
                self._act(room, action)
            except OSError as error:
                self._give_up(room, error)
                return

    def _act(self, room: RoomRecording, action: FileAction) -> None:
        if isinstance(action, OpenFile):
            self._open(room, action.episode)
        elif isinstance(action, CloseFile):
            self._close(room, action.episode)
        elif room.file is not None:
            room.file.add(action)

    def _open(self, room: RoomRecording, episode: EpisodeAccumulator) -> None:
        room.file = None
        room.file = EpisodeWriter(part_path(self._root, episode, room.facts))
        room.flushed_s = float("-inf")  # the first state is on the disk at once
        _log.info("%s: recording episode %d into %s", episode.room, episode.number, room.file.path)
        free = shutil.disk_usage(self._root).free
        if free < _LOW_SPACE_BYTES:
            text = f"The recorder's disk has {free / 1e6:.0f} MB left; make room before it is full."
            self._announcer.notice(episode.room, "warning", text)

    def _close(self, room: RoomRecording, episode: EpisodeAccumulator) -> None:
        file, room.file = room.file, None
        if file is None:
            return
        if episode.is_glimpse:
            file.discard()
        else:
            self._finalizer.finalize(file, episode, copy.deepcopy(room.facts))

    def _flush(self, room: RoomRecording, now_s: float) -> None:
        assert room.file is not None
        room.flushed_s = now_s
        try:
            describe(room.file, room.facts, self._models.known(room.facts.room, room.boot))
            room.file.flush()
        except OSError as error:
            self._give_up(room, error)

    def _give_up(self, room: RoomRecording, error: OSError) -> None:
        """The disk is full or broken: this episode is over, the room and its next episode are not."""
        episode, file = room.tracker.episode, room.file
        room.tracker.abandon()
        room.file = None
        if file is not None:
            file.abandon()
        number = f" {episode.number}" if episode is not None else ""
        where = f" What was written until now is in {file.path}." if file is not None else ""
        text = f"Recording of episode{number} stopped: {error.strerror}.{where} The next one is tried again."
        self._announcer.notice(room.facts.room, "error", text)

    def _report_losses(self, batch: InboxBatch) -> None:
        if not batch.lost_frames and not batch.lost_messages:
            return
        text = f"The recorder cannot keep up: {batch.lost_messages} messages and {batch.lost_frames} frames were lost."
        level = "error" if batch.lost_messages else "warning"
        for room in self._rooms.values():
            room.tracker.lost(batch.lost_messages, batch.lost_frames)
            if room.file is not None:
                self._announcer.notice(room.facts.room, level, text)


def _decode(kind: type[M], arrival: BusArrival) -> M:
    return codec.decode(kind, arrival.payload, _LIMIT_BYTES[arrival.kind])
