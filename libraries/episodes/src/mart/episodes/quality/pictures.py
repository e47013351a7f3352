"""Tell where a video pauses, by the times of its pictures. Pure; what is kept is bounded."""

from __future__ import annotations

from array import array

import numpy as np

_MAX_PICTURES = 1_000_000  # of one camera: nine hours at 30 a second
_PAUSE_PICTURES = 3.0


class PictureGaps:
    """Gather when pictures came, by their topic."""

    def __init__(self) -> None:
        self._arrived_ns: dict[str, array[int]] = {}

    def add(self, topic: str, arrived_ns: int) -> None:
        """Take one picture."""
        times = self._arrived_ns.setdefault(topic, array("Q"))
        if len(times) < _MAX_PICTURES:
            times.append(arrived_ns)

    def longest_s_and_share(self) -> tuple[float | None, float | None]:
        """Return the longest pause, and the share of the time in pauses of more than three pictures; the worst of both.

        A picture's usual time is the median between two. None where no camera has three pictures.
        """
        longest_s, shares = [], []
        for times in self._arrived_ns.values():
            if len(times) >= _PAUSE_PICTURES:
                between_s = np.diff(np.sort(np.array(times)).astype(np.int64)) / 1e9
                paused = between_s > _PAUSE_PICTURES * np.median(between_s)
                longest_s.append(float(between_s.max()))
                shares.append(float(between_s[paused].sum() / max(between_s.sum(), 1e-9)))
        return (max(longest_s), max(shares)) if longest_s else (None, None)
