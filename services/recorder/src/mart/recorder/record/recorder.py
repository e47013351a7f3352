"""Record every room: what arrives goes to the recording of its room; what takes long is left to a `FinalizeWorker`."""

from __future__ import annotations

import logging
import threading
from collections.abc import Container
from pathlib import Path

from mart.protocol import clock, keys
from mart.protocol.errors import InvalidInput
from mart.recorder.record.announcer import Announcer
from mart.recorder.record.arrival_decoder import UnusableArrivals
from mart.recorder.record.finalize import VerifyFile
from mart.recorder.record.finalize_worker import FinalizeWorker, TidyFolder
from mart.recorder.record.inbox import Inbox, InboxBatch
from mart.recorder.record.recorder_metrics import RecorderMetrics
from mart.recorder.record.room_claim import RoomClaim, claim_room
from mart.recorder.record.room_models import RoomModels
from mart.recorder.record.room_recording import RecordingTools, RoomRecording
from mart.runtime.bus import Bus
from mart.runtime.rate_limit import KeyedRateLimit

_STEP_S = 0.05
_MAX_ROOMS = 64
_TELL_AGAIN_S = 60.0
_CLAIM_AGAIN_S = 1.0
_TIDY_FIRST_S = (
    5.0  # what a crash has left gets its name before what was missed is heard again; that waits in the inbox
)

_log = logging.getLogger(__name__)


class Recorder:
    """Take arrivals from an inbox and write them, in the caller's thread.

    data_dir: `episodes` below it is where files go. live_rooms: the rooms that have a sim; no other is recorded.
    verify: says whether a finished file follows bit for bit. tidy: repairs what an earlier run has left, and brings the
    catalogue up to date. name: of this recorder, as rooms are told.
    """

    def __init__(
        self,
        data_dir: Path,
        bus: Bus,
        inbox: Inbox,
        *,
        live_rooms: Container[str],
        verify: VerifyFile,
        tidy: TidyFolder,
        name: str = "recorder-1",
    ) -> None:
        root = data_dir.resolve() / "episodes"
        models, announcer = RoomModels(bus), Announcer(bus, data_dir.resolve(), name)
        self._tools = RecordingTools(
            root, models, announcer, FinalizeWorker(root, models, announcer, verify, tidy)
        )
        self._inbox, self._live_rooms = inbox, live_rooms
        self._rooms: dict[str, RoomRecording] = {}
        self._unusable = UnusableArrivals()
        self._metrics = RecorderMetrics(root)
        self._tellings = KeyedRateLimit(1, _TELL_AGAIN_S)
        self._claim_tries = KeyedRateLimit(1, _CLAIM_AGAIN_S)

    def run(self, stop: threading.Event) -> None:
        """Record until `stop` is set, then save what is open."""
        self._tools.root.mkdir(parents=True, exist_ok=True)
        self._tools.finalizer.tidy(wait_s=_TIDY_FIRST_S)
        try:
            while not stop.is_set():
                self.step(_STEP_S)
        finally:
            self.close()

    def step(self, timeout_s: float) -> None:
        """Take what has arrived, waiting `timeout_s` at most for something, and do what it is time for."""
        batch = self._inbox.take(timeout_s)
        now_s = clock.monotonic_s()
        self._metrics.took(batch, clock.wall_ns())
        self._report_losses(batch)
        for arrival in batch.arrivals:
            try:
                self._recording(arrival.room, now_s).take(arrival, now_s)
            except InvalidInput as error:
                self._unusable.add(arrival, error, now_s)
            except Exception:  # noqa: BLE001 - one message must not end the recording of all rooms
                _log.exception("A %s on %s could not be taken", arrival.kind.name.lower(), arrival.key)
        for room in self._rooms.values():
            room.advance(now_s)
        self._forget()
        writing = sum(room.is_writing for room in self._rooms.values())
        unsaved = self._tools.finalizer.unsaved
        self._metrics.worked(rooms=len(self._rooms), writing=writing, unsaved=unsaved, now_s=now_s)

    def close(self) -> None:
        """End what is being recorded and wait until everything is saved."""
        for room in self._rooms.values():
            room.finish("the recorder was stopped")
        self._tools.finalizer.close()
        for name in list(self._rooms):
            self._leave(name)

    def _recording(self, name: str, now_s: float) -> RoomRecording:
        if name not in self._rooms:
            keys.state(name)  # raises InvalidInput for a name that no room can have
            if name not in self._live_rooms:
                raise InvalidInput(f"Room {name!r} has no sim that is alive; it is not recorded.")
            if len(self._rooms) >= _MAX_ROOMS:
                self._make_place(name, now_s)
            self._rooms[name] = RoomRecording(name, self._tools, self._claim(name, now_s))
        return self._rooms[name]

    def _claim(self, name: str, now_s: float) -> RoomClaim:
        """Claim a room, trying once a second; raises InvalidInput where another recorder has it."""
        claim = None
        if not self._claim_tries.wait_s(name, now_s):
            self._claim_tries.count(name, now_s)
            claim = claim_room(self._tools.root, name)
        if claim is None:
            raise InvalidInput(f"Room {name!r} is recorded into {self._tools.root} by another recorder.")
        return claim

    def _make_place(self, name: str, now_s: float) -> None:
        """Leave the room that was silent longest; raises InvalidInput, and tells the room, where all are recorded."""
        quiet = [room for room, recording in self._rooms.items() if not recording.is_writing]
        if not quiet:
            text = f"{_MAX_ROOMS} rooms are being recorded, which is the most; this one is not."
            if not self._tellings.wait_s(name, now_s):
                self._tellings.count(name, now_s)
                self._tools.announcer.notice(name, "error", text)
            raise InvalidInput(f"Room {name!r}: {text}")
        self._leave(min(quiet, key=lambda room: self._rooms[room].heard_s))

    def _forget(self) -> None:
        """Leave rooms whose sim is gone; a file that is open is closed first, by silence at the latest."""
        idle = [name for name, room in self._rooms.items() if not room.is_writing]
        for name in idle:
            if name not in self._live_rooms:
                self._leave(name)

    def _leave(self, name: str) -> None:
        self._rooms.pop(name).claim.release()

    def _report_losses(self, batch: InboxBatch) -> None:
        if not batch.lost_frames and not batch.lost_messages:
            return
        text = f"The recorder cannot keep up: {batch.lost_messages} messages and {batch.lost_frames} frames were lost."
        for room in self._rooms.values():
            room.count_losses(batch.lost_messages, batch.lost_frames, text)
