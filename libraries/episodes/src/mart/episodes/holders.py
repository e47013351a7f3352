"""Say who held each arm's seat in each tick: numbers, and a table of whom they stand for. Pure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mart.protocol.recording import OperatorsRecord

UNKNOWN = -1  # of an arm of which nothing was written down


def holders_of(
    operators: OperatorsRecord, arms: Sequence[str], ticks: NDArray[np.int64]
) -> tuple[NDArray[np.int16], tuple[str, ...]]:
    """Return int16[len(ticks), arms], who held the seat in each of these ticks, and whom the numbers stand for.

    ticks: of the episode, each one's state the first that it led to. A holder is a kind and, where it has one, a name
    (`human Ana`, `hold`); who left and came back is the same one.
    """
    names = tuple(dict.fromkeys(shift.holder for arm in arms for shift in operators.shifts.get(arm, ())))
    found = np.full((len(ticks), len(arms)), UNKNOWN, np.int16)
    for column, arm in enumerate(arms):
        for shift in operators.shifts.get(arm, ()):
            found[ticks >= shift.episode_tick, column] = names.index(shift.holder)
    return found, names
