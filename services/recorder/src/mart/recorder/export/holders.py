"""Number who held the seats in all episodes of an export, and say whom the numbers stand for. Pure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.vocabulary import OperatorKind

NOBODY = OperatorKind.HOLD.value  # number 0 of every export


def holders_in(episodes: Iterable[LabelledEpisode]) -> tuple[str, ...]:
    """Return everybody who held a seat, each once, as `Shift.holder` names them; nobody is the first."""
    shifts = (shift.holder for episode in episodes for shift in episode.shifts)
    return tuple(dict.fromkeys([NOBODY, *shifts]))


def holder_column(data: EpisodeData, holders: Sequence[str]) -> NDArray[np.int64]:
    """Return int64[T, arms], who held each seat, by the numbers of the export; -1 where nobody wrote it down."""
    numbers = np.array([*map(holders.index, data.holder_names), -1], np.int64)
    found: NDArray[np.int64] = numbers[data.holders]  # -1 is the last
    return found


def told_holders(holders: Sequence[str], with_names: bool) -> list[str]:
    """Return whom the numbers stand for; without names `human 1`, `human 2`, `policy 1`, so that no one is known."""
    if with_names:
        return [*holders]
    seen: Counter[str] = Counter()
    told = []
    for holder in holders:
        kind = holder.partition(" ")[0]
        seen[kind] += 1
        told.append(kind if holder == NOBODY else f"{kind} {seen[kind]}")
    return told
