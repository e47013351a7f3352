"""Choose how large a seat's picture is: one that takes too long is made smaller, because late is worse than coarse.

Pure. Where a machine's cores are shared by several seats and their browsers, how long a picture takes is mostly how
long it waits for its turn; half the pixels bring all of them forward.
"""

from __future__ import annotations

import math
from collections import deque
from fractions import Fraction
from statistics import median

SIZES = (Fraction(1), Fraction(3, 4), Fraction(1, 2))
_NOT_PIXELS = 0.3  # of what a full picture takes: 14, 11 and 7 ms were measured at these sizes
_PICTURES = 8  # that are looked at together
_MOST = 0.6  # of the time between two pictures; more, and the next state waits for this one
_ROOMY = 0.4  # what a larger picture may be expected to take
_FIRST_PATIENCE_S = 10.0
_LONGEST_PATIENCE_S = 300.0


def at_full_size(took_s: float, size: Fraction) -> float:
    """Return what a picture is expected to take at the full size that took so long at this share of the width."""
    return took_s / (_NOT_PIXELS + (1.0 - _NOT_PIXELS) * float(size) ** 2)


class AdaptiveResolution:
    """Choose one of `SIZES`, a share of the full width, by how long pictures take."""

    def __init__(self, frames_per_s: float) -> None:
        self._period_s = 1.0 / frames_per_s
        self._at = 0
        self._took_s: deque[float] = deque(maxlen=_PICTURES)
        self._changed_s = 0.0
        self._grown_s = -math.inf
        self._patience_s = _FIRST_PATIENCE_S

    @property
    def size(self) -> Fraction:
        """Return the size of the next picture, as a share of the full width."""
        return SIZES[self._at]

    def record(self, took_s: float, now_s: float) -> Fraction:
        """Take how long a picture took; returns the size of the next one."""
        self._took_s.append(took_s)
        if len(self._took_s) == _PICTURES:
            busy = median(self._took_s) / self._period_s
            if busy > _MOST and self.size > SIZES[-1]:
                self._grow_later(now_s)
                self._change(self._fitting(busy), now_s)
            elif self._at and self._busy_at(self._at - 1, busy) < _ROOMY and self._has_waited(now_s):
                self._change(self._at - 1, now_s)
                self._grown_s = now_s
        return self.size

    def _busy_at(self, at: int, busy: float) -> float:
        """Return the share of the time that another size is expected to take: in proportion to its pixels."""
        return busy * float(SIZES[at] / self.size) ** 2

    def _fitting(self, busy: float) -> int:
        """Return the largest of the smaller sizes that is expected to be in time, or the smallest."""
        smaller = range(self._at + 1, len(SIZES))
        return next((at for at in smaller if self._busy_at(at, busy) <= _MOST), smaller[-1])

    def _has_waited(self, now_s: float) -> bool:
        return now_s - self._changed_s > self._patience_s

    def _grow_later(self, now_s: float) -> None:
        """Wait twice as long before growing again, where the last growth was followed by this shrinking."""
        soon = now_s - self._grown_s < _FIRST_PATIENCE_S
        self._patience_s = min(2.0 * self._patience_s, _LONGEST_PATIENCE_S) if soon else _FIRST_PATIENCE_S

    def _change(self, at: int, now_s: float) -> None:
        self._at = at
        self._changed_s = now_s
        self._took_s.clear()
