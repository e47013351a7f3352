"""Record every room: what arrives goes to the recording of its room; what takes long is left to a `FinalizeWorker`."""

from __future__ import annotations

import threading
from pathlib import Path

from mart.protocol import clock, keys
from mart.protocol.errors import InvalidInput
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.arrival_decoder import UnusableArrivals
from mart.recorder.record.episode_closing import SILENCE_S
from mart.recorder.record.finalize import VerifyFile
from mart.recorder.record.finalize_worker import FinalizeWorker, TidyFolder
from mart.recorder.record.inbox import Inbox, InboxBatch
from mart.recorder.record.room_models import RoomModels
from mart.recorder.record.room_recording import RecordingTools, RoomRecording
from mart.runtime.bus import Bus

_STEP_S = 0.05
_MAX_ROOMS = 64


class Recorder:
    """Take arrivals from an inbox and write them, in the caller's thread.

    data_dir: `episodes` below it is where files go. verify: says whether a finished file follows bit for bit.
    tidy: repairs what an earlier run has left, and brings the catalogue up to date.
    """

    def __init__(self, data_dir: Path, bus: Bus, inbox: Inbox, verify: VerifyFile, tidy: TidyFolder) -> None:
        root = data_dir.resolve() / "episodes"
        models, announcer = RoomModels(bus), Announcer(bus, data_dir.resolve())
        self._tools = RecordingTools(
            root, models, announcer, FinalizeWorker(root, models, announcer, verify, tidy)
        )
        self._inbox = inbox
        self._rooms: dict[str, RoomRecording] = {}
        self._unusable = UnusableArrivals()

    def run(self, stop: threading.Event) -> None:
        """Record until `stop` is set, then save what is open."""
        self._tools.root.mkdir(parents=True, exist_ok=True)
        self._tools.finalizer.tidy()
        try:
            while not stop.is_set():
                self.step(_STEP_S)
        finally:
            self.close()

    def step(self, timeout_s: float) -> None:
        """Take what has arrived, waiting `timeout_s` at most for something, and do what it is time for."""
        batch = self._inbox.take(timeout_s)
        now_s = clock.monotonic_s()
        self._report_losses(batch)
        for arrival in batch.arrivals:
            try:
                self._recording(arrival.room, now_s).take(arrival, now_s)
            except InvalidInput as error:
                self._unusable.add(arrival, error, now_s)
        for room in self._rooms.values():
            room.advance(now_s)

    def close(self) -> None:
        """End what is being recorded and wait until everything is saved."""
        for room in self._rooms.values():
            room.finish("the recorder was stopped")
        self._tools.finalizer.close()

    def _recording(self, name: str, now_s: float) -> RoomRecording:
        if name not in self._rooms:
            keys.state(name)  # raises InvalidInput for a name that no room can have
            if len(self._rooms) >= _MAX_ROOMS:
                self._forget_silent(now_s)
            if len(self._rooms) >= _MAX_ROOMS:
                raise InvalidInput(f"Room {name!r} is one too many; at most {_MAX_ROOMS} are recorded.")
            self._rooms[name] = RoomRecording(name, self._tools)
        return self._rooms[name]

    def _forget_silent(self, now_s: float) -> None:
        """Leave rooms that have ended: nobody tells of a room that it was closed."""
        self._rooms = {
            name: room
            for name, room in self._rooms.items()
            if room.is_writing or now_s - room.heard_s <= SILENCE_S
        }

    def _report_losses(self, batch: InboxBatch) -> None:
        if not batch.lost_frames and not batch.lost_messages:
            return
        text = f"The recorder cannot keep up: {batch.lost_messages} messages and {batch.lost_frames} frames were lost."
        for room in self._rooms.values():
            room.count_losses(batch.lost_messages, batch.lost_frames, text)
