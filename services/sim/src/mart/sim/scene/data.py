"""Read and write the data of one world, or of a batch of them: what scenes and arms share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

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
    chosen = list(rows)
    assert _are_even(chosen)
    step = chosen[1] - chosen[0] if len(chosen) > 1 else 1
    return slice(chosen[0], chosen[-1] + 1, step)


def _are_even(rows: Sequence[int]) -> bool:
    steps = {after - before for before, after in pairwise(rows)}
    return len(rows) > 0 and len(steps) < 2 and min(steps, default=1) > 0


class ChosenRows:
    """Choose rows of an array of the data, shape (..., rows, n), and follow it.

    Rows that lie equally far apart, as those of equal arms do, are one view; others are put together when read.
    """

    def __init__(self, array: Array, rows: Sequence[int]) -> None:
        self._view = array[..., evenly(rows), :] if _are_even(rows) else None
        self._views = [array[..., row, :] for row in rows]
        self._none = array[..., :0, :]

    def read(self) -> Array:
        """Return the rows as they are now, shape (..., chosen, n)."""
        if self._view is not None:
            return self._view
        return np.stack(self._views, axis=-2) if self._views else self._none


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
