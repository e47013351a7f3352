"""Show how a recorder keeps up: what it took from its inbox, what waits, what was lost, and its disk."""

from __future__ import annotations

import shutil
from pathlib import Path

from prometheus_client import Counter, Gauge, Histogram

from mart.recorder.record.inbox import InboxBatch
from mart.runtime.metrics import REGISTRY
from mart.runtime.rate_limit import RateLimit

LAG = Histogram(
    "mart_recorder_lag_seconds",
    "How old the oldest message was each time that some were taken from the inbox.",
    buckets=(0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0),
    registry=REGISTRY,
)
LOST = Counter(
    "mart_recorder_lost",
    "What the recorder could not keep up with and left out: messages (states, commands, events) or frames of video.",
    ("what",),
    registry=REGISTRY,
)
ROOMS = Gauge("mart_recorder_rooms", "Rooms that are recorded or listened to.", registry=REGISTRY)
OPEN_FILES = Gauge("mart_recorder_writing_rooms", "Rooms of which a file is open.", registry=REGISTRY)
UNSAVED = Gauge(
    "mart_recorder_unsaved_episodes",
    "Episodes that have ended and are being verified or completed.",
    registry=REGISTRY,
)
SAVED = Counter(
    "mart_recorder_saved_episodes",
    "Episodes that were told to be saved, by verdict.",
    ("verdict",),
    registry=REGISTRY,
)
VERIFICATIONS = Gauge(
    "mart_recorder_verification_queue_episodes",
    "Saved episodes that wait for their verification.",
    registry=REGISTRY,
)
DISK_FREE = Gauge("mart_recorder_disk_free_bytes", "Free on the disk of the episodes.", registry=REGISTRY)
DISK_SIZE = Gauge("mart_recorder_disk_size_bytes", "Size of the disk of the episodes.", registry=REGISTRY)

_DISK_EVERY_S = 5.0


class RecorderMetrics:
    """Take a recorder's figures where it works. root: the folder of the episodes."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._disk = RateLimit(1, _DISK_EVERY_S)
        self._lost = {what: LOST.labels(what) for what in ("messages", "frames")}

    def took(self, batch: InboxBatch, now_wall_ns: int) -> None:
        """Take what came out of the inbox. now_wall_ns: Unix time."""
        if batch.arrivals:
            LAG.observe(max(0.0, (now_wall_ns - batch.arrivals[0].arrived_ns) * 1e-9))
        self._lost["messages"].inc(batch.lost_messages)
        self._lost["frames"].inc(batch.lost_frames)

    def worked(self, *, rooms: int, writing: int, unsaved: int, now_s: float) -> None:
        """Take how things stand after a step. now_s: monotonic seconds."""
        ROOMS.set(rooms)
        OPEN_FILES.set(writing)
        UNSAVED.set(unsaved)
        if self._disk.allows(now_s):
            self._look_at_disk()

    def _look_at_disk(self) -> None:
        try:
            usage = shutil.disk_usage(self._root)
        except OSError:  # its folder is gone, which the recorder tells by itself
            DISK_FREE.set(0)
            return
        DISK_FREE.set(usage.free)
        DISK_SIZE.set(usage.total)
