"""What scenes and arms read and write: the data of one world, or of a batch of them."""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

# The same names in both; in a batch, every array has the worlds as its first axis.
Data = mujoco.MjData | Batch

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def apply(matrix: Array, vectors: Array) -> Array:
    """matrix @ vectors, shapes (m, n) and (..., n).

    Sums in one fixed order, so that a world gives the same bits alone and in a batch; a matrix product does not.
    """
    terms = vectors[..., None, :] * matrix
    total = terms[..., 0]
    for column in range(1, matrix.shape[1]):
        total = total + terms[..., column]
    return total
