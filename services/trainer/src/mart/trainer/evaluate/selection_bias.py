"""What choosing the best of several checkpoints adds to its rate, where all of them were equally good."""

from __future__ import annotations

import math


def expected_best(rate: float, checkpoints: int, episodes: int) -> float:
    """Return the highest rate that so many equal checkpoints show on average, in so many episodes each.

    rate: the true one of each, 0 … 1. Rates of checkpoints that were played in the same worlds lie closer together than
    these, and unequal checkpoints are chosen among less freely: what selection really added is at most about this much.
    """
    expected, below = 0.0, 0.0
    for hits in range(episodes + 1):
        below += math.comb(episodes, hits) * rate**hits * (1 - rate) ** (episodes - hits)
        expected += 1.0 - min(below, 1.0) ** checkpoints  # E[X] is the sum of P(X > hits)
    return expected / episodes
