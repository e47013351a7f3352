"""How a recorder keeps up is shown."""

from __future__ import annotations

from pathlib import Path

from mart.recorder.record.inbox import ArrivalKind, BusArrival, InboxBatch
from mart.recorder.record.recorder_metrics import RecorderMetrics
from mart.runtime.metrics import REGISTRY


def _value(name: str, **labels: str) -> float:
    return REGISTRY.get_sample_value(name, labels) or 0.0


def test_lag_is_that_of_the_oldest_and_losses_add_up(tmp_path: Path) -> None:
    metrics = RecorderMetrics(tmp_path)
    before = _value("mart_recorder_lag_seconds_sum"), _value("mart_recorder_lost_total", what="frames")
    arrivals = [BusArrival(ArrivalKind.STATE, "mart/room/state", b"", at_ns) for at_ns in (10**9, 2 * 10**9)]
    metrics.took(InboxBatch(arrivals, lost_frames=2), 4 * 10**9)
    metrics.took(InboxBatch([], lost_frames=1), 9 * 10**9)
    assert _value("mart_recorder_lag_seconds_sum") - before[0] == 3.0
    assert _value("mart_recorder_lost_total", what="frames") - before[1] == 3


def test_the_disk_is_looked_at_now_and_then_and_one_that_is_gone_counts_as_full(tmp_path: Path) -> None:
    metrics = RecorderMetrics(tmp_path)
    metrics.worked(rooms=2, writing=1, unsaved=3, now_s=0.0)
    assert _value("mart_recorder_rooms") == 2
    assert 0 < _value("mart_recorder_disk_free_bytes") <= _value("mart_recorder_disk_size_bytes")
    gone = RecorderMetrics(tmp_path / "gone")
    gone.worked(rooms=0, writing=0, unsaved=0, now_s=0.0)
    assert _value("mart_recorder_disk_free_bytes") == 0
