"""Judge whether a camera gives pictures that people may drive by. Pure: pictures and `now_s` (monotonic) in, words out.

A camera is dark while it is not open, while no picture comes, while all are the very same, and while they are black. A
picture of a sensor is never twice the same: it has noise.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass

from mart.render import Image

SILENT_AFTER_S = 1.0
FROZEN_AFTER_S = 5.0
BLACK_AFTER_S = 2.0
_EVERY = 4  # manieth pixel of a row and of a column is looked at
_BLACK_MEAN, _BLACK_SPREAD = 6.0, 3.0  # of 255


@dataclass(frozen=True)
class CameraDarkness:
    """Say why a camera gives no picture, in a sentence, and since when."""

    why: str
    since_s: float


class PictureHealth:
    """Follow one camera. frozen_after_s: infinity for one that may well show the same for ever."""

    def __init__(self, now_s: float, frozen_after_s: float = FROZEN_AFTER_S) -> None:
        self._frozen_after_s = frozen_after_s
        self._failure = "It is being opened."
        self._dark_s = now_s
        self._newest_s = now_s
        self._digest = 0
        self._changed_s = now_s
        self._black_s: float | None = None

    def opened(self, now_s: float) -> None:
        """Take that it is open; pictures are to follow."""
        self._failure = ""
        self._newest_s = self._changed_s = now_s
        self._black_s = None

    def failed(self, why: str, now_s: float) -> None:
        """Take that it failed, and why: a sentence without its full stop."""
        if not self._failure:
            self._dark_s = now_s
        self._failure = f"{why}; it is tried again."

    def see(self, picture_bgr: Image, now_s: float) -> bool:
        """Take a picture, and tell whether it may be shown as a new one."""
        self._newest_s = now_s
        sample = picture_bgr[::_EVERY, ::_EVERY]
        digest = zlib.crc32(sample.tobytes())
        if digest != self._digest:
            self._digest, self._changed_s = digest, now_s
        if sample.mean() > _BLACK_MEAN or sample.std() > _BLACK_SPREAD:
            self._black_s = None
        elif self._black_s is None:
            self._black_s = now_s
        return self.darkness(now_s) is None

    def darkness(self, now_s: float) -> CameraDarkness | None:
        """Return why it gives no picture; None while all is well."""
        if self._failure:
            return CameraDarkness(self._failure, self._dark_s)
        if now_s - self._newest_s > SILENT_AFTER_S:
            return CameraDarkness("No picture comes from it.", self._newest_s)
        if self._black_s is not None and now_s - self._black_s > BLACK_AFTER_S:
            return CameraDarkness("Its picture is black.", self._black_s)
        if now_s - self._changed_s > self._frozen_after_s:
            return CameraDarkness("Its picture is frozen.", self._changed_s)
        return None


def wait_before_opening_s(failures: int) -> float:
    """Return how long to wait after so many failures in a row: from half a second to eight."""
    return min(8.0, 0.5 * 2.0 ** min(failures - 1, 8)) if failures else 0.0
