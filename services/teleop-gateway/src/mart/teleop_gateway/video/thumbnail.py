"""Make a small picture of a seat's view every two seconds: what the lobby shows of the room."""

from __future__ import annotations

from dataclasses import dataclass

import cv2

from mart.render import Image

EVERY_S = 2.0
_SIZE_PX = (384, 288)
_JPEG_QUALITY = 80


@dataclass(frozen=True)
class Thumbnail:
    """Hold a small JPEG. `image_ns` is when the world was in this state."""

    jpeg: bytes
    image_ns: int


class ThumbnailMaker:
    """Make a thumbnail whenever one is due."""

    def __init__(self) -> None:
        self._due_s = 0.0

    def is_due(self, now_s: float) -> bool:
        """Tell whether the next view becomes a thumbnail."""
        return now_s >= self._due_s

    def take(self, view_rgb: Image, image_ns: int, now_s: float) -> Thumbnail | None:
        """Return a thumbnail of a view, shape (height, width, 3); None where the last one is not old enough."""
        if not self.is_due(now_s):
            return None
        self._due_s = now_s + EVERY_S
        small = cv2.resize(view_rgb, _SIZE_PX, interpolation=cv2.INTER_AREA)
        _, jpeg = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
        return Thumbnail(jpeg.tobytes(), image_ns)
