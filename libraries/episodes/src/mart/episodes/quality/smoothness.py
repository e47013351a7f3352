"""Tell how smooth a motion of the tool is, whatever rate it was recorded at and however long it took. Pure.

The measure is of windows of 2 s, and the median over those in which the tool travels counts: over a whole episode it
grows with the length, so that it would tell slow from quick instead of jerky from smooth. Before, the way is smoothed
with a Gaussian of 0.1 s and told at 20 Hz, so that 20 and 60 Hz of one motion give one number. What else was tried:
docs/decisions/0086-quality-is-measured-and-never-decides.md.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

COMMON_HZ = 20.0
WINDOW_S = 2.0
MIN_TRAVEL_M = 0.02  # of a window that counts: less is a hand that rests
_SIGMA_S = 0.1
_REACH_SIGMAS = 4


def log_dimensionless_jerk(way_m: Array, rate_hz: float) -> float | None:
    """Return the median of -ln(T³/v² · ∫ jerk² dt) over the windows: nearer to 0 is smoother; None of no motion.

    v is the window's highest speed. N. Hogan, D. Sternad, Sensitivity of smoothness measures to movement duration,
    amplitude, and arrests, J. Motor Behavior 41(6), 2009; its logarithm: S. Balasubramanian, A. Melendez-Calderon,
    A. Roby-Brami, E. Burdet, On the analysis of movement smoothness, J. NeuroEng. and Rehabilitation 12:112, 2015.

    way_m: float64[N, 3], positions at even times.
    """
    found = [_log_dimensionless_jerk(window) for window in _windows(way_m, rate_hz)]
    return float(np.median(found)) if found else None


def _windows(way_m: Array, rate_hz: float) -> Iterator[Array]:
    """Iterate over the windows in which the tool travels, each float64[41, 3] at 20 Hz, by half a window."""
    way = _at_common_rate(way_m, rate_hz)
    size = int(WINDOW_S * COMMON_HZ)
    for start in range(0, len(way) - size, size // 2):
        window = way[start : start + size + 1]
        if np.linalg.norm(np.diff(window, axis=0), axis=1).sum() >= MIN_TRAVEL_M:
            yield window


def _at_common_rate(way: Array, rate_hz: float) -> Array:
    """Return the smoothed way at 20 Hz: each place the mean of those around it, weighted with a Gaussian of time."""
    count = int((len(way) - 1) * COMMON_HZ / rate_hz + 1e-6) + 1
    middles = np.arange(count) * rate_hz / COMMON_HZ  # in ticks of the recording
    reach = int(np.ceil(_REACH_SIGMAS * _SIGMA_S * rate_hz))
    ticks = np.round(middles).astype(np.int64)[:, None] + np.arange(-reach, reach + 1)
    weights = np.exp(-0.5 * ((ticks - middles[:, None]) / (_SIGMA_S * rate_hz)) ** 2)
    weights /= weights.sum(axis=1, keepdims=True)
    ticks = np.clip(ticks, 0, len(way) - 1)
    return np.stack([(weights * column[ticks]).sum(axis=1) for column in way.T], axis=1)


def _log_dimensionless_jerk(window: Array) -> float:
    speeds = np.linalg.norm(np.diff(window, axis=0), axis=1) * COMMON_HZ
    jerks = np.diff(window, n=3, axis=0) * COMMON_HZ**3
    total = float((jerks**2).sum()) / COMMON_HZ * WINDOW_S**3 / float(speeds.max()) ** 2
    return -float(np.log(max(total, 1e-12)))
