"""Find the stretches of an episode in which no arm moves: waiting, thinking, a hand that rests. Pure.

Policies learn to stand still from them (huggingface/lerobot#2111, ARISE-Initiative/robosuite#188), and what is learned
of a motion gets less of the data.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.episodes.edits import Range
from mart.protocol.errors import InvalidInput

STILL_M = 0.002  # an arm that a person holds still trembles less
STILL_RAD = 0.02
MIN_IDLE_S = 0.2


def idle_ranges(data: EpisodeData, min_s: float) -> list[Range]:
    """Return the ranges of transitions, of at least so many simulated seconds, in which every arm stands still.

    An arm stands still as long as its tool stays within 2 mm and 0.02 rad of where it was when the stretch began, and
    its gripper is told the same. The transition in which a gripper is told something new is none of the stretch.
    Raises InvalidInput for less than 0.2 s: arms that turn round stand still for so long.
    """
    if not min_s >= MIN_IDLE_S:
        raise InvalidInput(f"Idle stretches of {min_s:g} s were asked for; at least {MIN_IDLE_S:g} s can be.")
    told_anew = np.zeros(len(data), dtype=bool)
    told_anew[1:] = (np.diff(data.actions[:, :, 6], axis=0) != 0).any(axis=1)
    found: list[Range] = []
    last = -1
    for start in _still_after(data, min_s):
        if start < last or told_anew[start]:
            continue
        end = _end_of_stillness(data, int(start), told_anew)
        if data.sim_time_s[end] - data.sim_time_s[start] >= min_s:
            found.append((int(start), end))
            last = end
    return found


def _still_after(data: EpisodeData, min_s: float) -> NDArray[np.int64]:
    """Return the transitions, rising, after which every arm is where it was when they began, so many seconds later."""
    # The small number keeps what division makes of a time from asking for one tick more.
    later = np.searchsorted(data.sim_time_s, data.sim_time_s[:-1] + min_s - 1e-9)
    starts = np.flatnonzero(later <= len(data))
    return starts[~_moved(data, starts, later[starts])]


def _end_of_stillness(data: EpisodeData, start: int, told_anew: NDArray[np.bool_]) -> int:
    """Return the first state after `start` from which on an arm moves, or is told to grip or to let go."""
    reach = 64
    while True:
        ends = np.arange(start + 1, min(start + reach, len(data)) + 1)
        moving = _moved(data, np.full_like(ends, start), ends) | told_anew[ends - 1]
        if moving.any():
            return start + int(np.argmax(moving))
        if ends[-1] == len(data):
            return len(data)
        reach *= 2


def _moved(data: EpisodeData, before: NDArray[np.int64], after: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Tell for each pair of states whether any arm is elsewhere."""
    positions, quaternions = data.tool_positions_in_base, data.tool_quaternions_in_base
    moved_m = np.linalg.norm(positions[after] - positions[before], axis=-1)
    cosines = np.abs((quaternions[after] * quaternions[before]).sum(axis=-1))
    turned_rad = 2 * np.arccos(np.minimum(cosines, 1.0))
    return ((moved_m > STILL_M) | (turned_rad > STILL_RAD)).any(axis=-1)
