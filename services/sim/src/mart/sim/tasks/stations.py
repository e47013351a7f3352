"""Keep the score of stations that are done one after another: for each how long it took, and in how many tries.

All of it is in the scene's memory, so that a world that is stepped again keeps the same score. Shapes (...) are () in a
world and (worlds,) in a batch.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mart.sim.scene.data import Array, Flags

HOLD_S = 0.5  # so long a station's condition must hold
_FIELDS = 5  # of each station: done, seconds, tries, tried now, held for so many seconds


def memory_size(stations: int) -> int:
    """Return how many numbers the score of so many stations takes."""
    return _FIELDS * stations + 1


class StationScores:
    """View the scores in the scene's memory, shape (..., memory_size(stations)).

    before: for each station, the stations that must be done before it begins.
    """

    def __init__(self, memory: Array, before: Sequence[Sequence[int]]) -> None:
        count = len(before)
        fields = memory[..., :-1].reshape(*memory.shape[:-1], count, _FIELDS)
        self._done, self.seconds, self.tries, self._tried, self._held_s = (
            fields[..., index] for index in range(_FIELDS)
        )
        self._last_s = memory[..., -1]
        self._before: NDArray[np.bool_] = np.zeros((count, count), dtype=np.bool_)
        for station, earlier in enumerate(before):
            self._before[station, list(earlier)] = True

    @property
    def done(self) -> Flags:
        """Return which stations are done, shape (..., stations)."""
        return self._done > 0

    @property
    def current(self) -> Flags:
        """Return which stations have begun and are not done, shape (..., stations)."""
        awaits = np.logical_or.reduce(~self.done[..., None, :] & self._before, axis=-1)
        return ~self.done & ~awaits

    def see(self, time_s: Array | float, begun: Flags, left: Flags, fulfilled: Flags) -> None:
        """Take in how the world stands at `time_s` (simulated); flags have the shape (..., stations).

        A try begins where `begun` holds, and ends where `left` does: between the two it goes on.
        """
        current = self.current
        elapsed_s = np.asarray(time_s - self._last_s)[..., None]
        self._last_s[...] = time_s
        self.seconds += elapsed_s * current
        trying = current & (begun | ((self._tried > 0) & ~left))
        self.tries += trying & (self._tried == 0)
        self._tried[...] = trying
        self._held_s[...] = (self._held_s + elapsed_s) * (current & fulfilled)
        self._done[...] = self.done | (self._held_s > HOLD_S)
