"""Tell an episode as it was edited: arrays without what was cut out, a segment for each motion left. Pure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.episodes.edits import EpisodeEdits, Range

Rows = NDArray[np.int64]


def edited(data: EpisodeData, edits: EpisodeEdits) -> list[EpisodeData]:
    """Return the segments that are left of an episode, in its order; none where all of it was cut out.

    data: as it was recorded, every tick of it. Over a skip the motion goes on: the state after it takes the place of
    the one before it, so row t of the actions still leads from row t of the observations to row t + 1.
    """
    if not edits:
        return [data]
    corrected = replace(data, subtasks=_subtasks(data, edits))
    return [_segment(corrected, ranges) for ranges in edits.runs(len(data))]


def _segment(data: EpisodeData, ranges: list[Range]) -> EpisodeData:
    if len(ranges) == 1:  # the rows themselves, not a copy of them
        start, end = ranges[0]
        return data.rows(slice(start, end + 1), slice(start, end))
    moves = np.concatenate([np.arange(*one) for one in ranges])
    seen = np.append(moves, ranges[-1][1])
    return data.rows(seen, moves)


def _subtasks(data: EpisodeData, edits: EpisodeEdits) -> dict[str, NDArray[np.bool_]]:
    states = np.arange(len(data) + 1)
    said = {
        name: np.zeros(len(states), dtype=bool) if tick is None else states >= tick
        for name, tick in edits.subtasks.items()
    }
    return {**data.subtasks, **said}
