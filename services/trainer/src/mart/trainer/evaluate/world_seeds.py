"""Which worlds a policy is judged in: the same for every model, and never those that data was collected in.

Two streams that share nothing: checkpoints are selected in the worlds of one and scored in the worlds of the other, so
that a score has not profited from the selection.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

_STREAM = {"selection": 0x5E1EC7, "score": 0x5C04E}


class Purpose(StrEnum):
    """Name what an evaluation is for: choosing a checkpoint, or scoring the chosen one in fresh worlds."""

    SELECTION = "selection"
    SCORE = "score"


def world_seeds(purpose: Purpose, seed: int, number: int) -> tuple[int, ...]:
    """Return the first `number` seeds of a stream, 63 bits each; fewer are a prefix of more."""
    words = np.random.SeedSequence([_STREAM[purpose], seed]).generate_state(number, np.uint64)
    return tuple(int(word >> np.uint64(1)) for word in words)
