"""Measure how one arm was driven, over the segments that are left of an episode. Pure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.episodes.idle import idle_ranges
from mart.episodes.quality.measures import ArmQuality
from mart.episodes.quality.smoothness import log_dimensionless_jerk

IDLE_S = 1.0
LATE_S = 0.05  # what a hand feels
_CLOSED, _OPEN = 0.2, -0.2  # of the gripper's command, so that one that trembles about 0 is told once
_SHORTEST_STRAIGHT_M = 0.05

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def arm_quality(
    segments: Sequence[EpisodeData], arm: int, late_s: Array, lost: Sequence[Flags], rate_hz: float
) -> ArmQuality:
    """Measure the arm of this index.

    late_s: float64[T], how long each transition that is left waited for it. lost: for each segment bool[T], whether its
    hand was not known.
    """
    alone = [one_arm(segment, arm) for segment in segments]
    ways = [segment.tool_positions_in_base[:, 0] for segment in alone]
    changes = [_gripper_changes(segment.actions[:, 0, 6]) for segment in alone]
    idle = sum(idle_seconds(segment) for segment in alone)
    count = sum(map(len, alone))
    path_m = sum(_length(way) for way in ways)
    straight_m = sum(_length(way[_places(way, found)]) for way, found in zip(ways, changes, strict=True))
    lost_ticks = sum(int(flags.sum()) for flags in lost)
    closings = sum(closed for found in changes for _, closed in found)
    return ArmQuality(
        log_dimensionless_jerk=_weighted([(log_dimensionless_jerk(way, rate_hz), len(way)) for way in ways]),
        idle_s=idle,
        idle_share=idle * rate_hz / count,
        path_m=path_m,
        path_rad=sum(_turned(segment.tool_quaternions_in_base[:, 0]) for segment in alone),
        path_ratio=path_m / straight_m if straight_m >= _SHORTEST_STRAIGHT_M else None,
        regrasps=max(0, closings - 1),
        engagements=sum(_rises(segment.engaged[:, 0]) for segment in alone),
        held_share=float(np.concatenate([segment.held[:, 0] for segment in alone]).mean()),
        late_share=float((late_s >= LATE_S).mean()),
        waited_s=float(late_s.sum()),
        phone_losses=sum(map(_rises, lost)),
        phone_lost_s=lost_ticks / rate_hz,
        phone_lost_share=lost_ticks / count,
    )


def one_arm(data: EpisodeData, arm: int) -> EpisodeData:
    """Return the episode as if it had the arm of this index alone."""
    own = slice(arm, arm + 1)
    return replace(
        data,
        arms=data.arms[own],
        actions=data.actions[:, own],
        sources=data.sources[:, own],
        engaged=data.engaged[:, own],
        held=data.held[:, own],
        tool_positions_in_base=data.tool_positions_in_base[:, own],
        tool_quaternions_in_base=data.tool_quaternions_in_base[:, own],
    )


def idle_seconds(data: EpisodeData) -> float:
    """Return for how many simulated seconds no arm moved, in stretches of at least a second."""
    times = data.sim_time_s
    return float(sum(times[end] - times[start] for start, end in idle_ranges(data, IDLE_S)))


def _weighted(found: Sequence[tuple[float | None, int]]) -> float | None:
    """Return the mean of what there is of the segments, weighted by their lengths."""
    known = [(value, weight) for value, weight in found if value is not None]
    return sum(v * w for v, w in known) / sum(w for _, w in known) if known else None


def _length(way: Array) -> float:
    return float(np.linalg.norm(np.diff(way, axis=0), axis=-1).sum())


def _turned(quaternions: Array) -> float:
    cosines = np.abs((quaternions[1:] * quaternions[:-1]).sum(axis=-1))
    return float((2 * np.arccos(np.minimum(cosines, 1.0))).sum())


def _gripper_changes(told: Array) -> list[tuple[int, bool]]:
    """Return the transitions in which the gripper was told to close or to open, and which: (transition, closed)."""
    changes = []
    closed = bool(told[0] > _CLOSED)
    if closed:
        changes.append((0, True))
    for row in np.flatnonzero((told > _CLOSED) | (told < _OPEN)):
        if (told[row] > 0) != closed:
            closed = not closed
            changes.append((int(row), closed))
    return changes


def _places(way: Array, changes: Sequence[tuple[int, bool]]) -> list[int]:
    return [0, *(row for row, _ in changes if row > 0), len(way) - 1]


def _rises(flags: Flags) -> int:
    return int(flags[0]) + int((flags[1:] & ~flags[:-1]).sum())
