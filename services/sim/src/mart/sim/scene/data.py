"""Read and write the data of one world, or of a batch of them: what scenes and arms share."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray

# The same names in both; in a batch, every array has the worlds as its first axis.
Data = mujoco.MjData | Batch

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def evenly(rows: Iterable[int]) -> slice:
    """Return rows that lie equally far apart as a slice: what it chooses is a view that follows the data."""
    first, *others = rows
    step = others[0] - first if others else 1
    chosen = slice(first, first + step * len(others) + 1, step)
    assert list(range(chosen.start, chosen.stop, step)) == [first, *others]
    return chosen


def into_frame(rotation: Array, vectors: Array) -> Array:
    """Turn vectors of the world, shape (..., 3), into a frame whose axes are the columns of `rotation`, (..., 3, 3).

    Sums in one fixed order, so that a world gives the same bits alone and in a batch; a matrix product does not.
    """
    return np.add.reduce(vectors[..., None] * rotation, axis=-2)


def within(vectors: Array, limits: ArrayLike) -> Flags:
    """Return whether no component of a vector, shape (..., n), is further from 0 than its limit."""
    return np.logical_and.reduce(np.abs(vectors) < limits, axis=-1)


def length(vectors: Array) -> Array:
    """Return the lengths of vectors of shape (..., n), shape (...)."""
    return np.sqrt(np.add.reduce(vectors * vectors, axis=-1))
