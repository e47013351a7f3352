"""Say what policies are normalised with: of columns of numbers, and of pictures by their colours' histograms."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mart.recorder.export.videos import Histogram

_PERCENTS = (1, 10, 50, 90, 99)

Statistics = dict[str, list[Any]]  # by name; lists in the shape of the feature


def of_numbers(values: NDArray[Any]) -> Statistics:
    """Return the statistics of a column, one row a frame."""
    rows = values.reshape(len(values), -1).astype(np.float64)
    found = {"min": rows.min(0), "max": rows.max(0), "mean": rows.mean(0), "std": rows.std(0)}
    quantiles = {f"q{percent:02d}": np.quantile(rows, percent / 100, axis=0) for percent in _PERCENTS}
    return {name: value.tolist() for name, value in (found | quantiles).items()} | {"count": [len(rows)]}


def of_pictures(counts: Histogram, frames: int) -> Statistics:
    """Return the statistics of all pixels of so many pictures, in 0 … 1: lists of shape (3, 1, 1), one a channel."""
    levels = np.arange(counts.shape[1]) / (counts.shape[1] - 1.0)
    shares = counts / counts.sum(axis=1, keepdims=True)
    mean = shares @ levels
    below = np.cumsum(shares, axis=1)
    found = {
        "min": levels[(counts > 0).argmax(axis=1)],
        "max": levels[-1 - (counts[:, ::-1] > 0).argmax(axis=1)],
        "mean": mean,
        "std": np.sqrt((shares * (levels - mean[:, np.newaxis]) ** 2).sum(axis=1)),
    }
    quantiles = {
        f"q{percent:02d}": levels[(below >= percent / 100 - 1e-12).argmax(axis=1)] for percent in _PERCENTS
    }
    return {name: value.reshape(3, 1, 1).tolist() for name, value in (found | quantiles).items()} | {
        "count": [frames]
    }
