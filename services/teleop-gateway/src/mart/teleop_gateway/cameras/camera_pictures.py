"""Make of each captured picture what seats show and what files keep: a JPEG, and a picture of an H.264 stream."""

from __future__ import annotations

import cv2

from mart.render import Image
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.captured_pictures import PICTURES_PER_S, fit_into
from mart.teleop_gateway.video.encoder import CLOCK_HZ, RECORDED, EncodedPicture, Encoder
from mart.teleop_gateway.video.quality import Quality

_KEYFRAME_EVERY_S = 2.0  # an episode's file begins with one
_LIMIT_BPS = 8e6  # what a noisy camera may take
_JPEG = [cv2.IMWRITE_JPEG_QUALITY, 90]


class CameraPictures:
    """Encode one camera's pictures in one size. For one thread."""

    def __init__(self, quality: Quality) -> None:
        self._quality = quality
        self._picture = quality.blank_picture()
        self._encoder = Encoder(RECORDED, PICTURES_PER_S, quality, _LIMIT_BPS)
        self._keyframe_s: float | None = None

    def take(self, captured_bgr: Image) -> bytes:
        """Fit a captured picture into the seats' shape, and return it as a JPEG without the strip."""
        view = self._picture[: self._quality.view_height_px]
        fit_into(captured_bgr, view)
        _, jpeg = cv2.imencode(".jpg", view, _JPEG)
        return jpeg.tobytes()

    def encode(self, tick: int, captured_s: float) -> EncodedPicture:
        """Return the picture that was taken last for the file, with the tick that it shows in its strip."""
        tick_code.write(tick, self._picture[self._quality.view_height_px :])
        due = self._keyframe_s is None or captured_s - self._keyframe_s >= _KEYFRAME_EVERY_S
        i420 = cv2.cvtColor(self._picture, cv2.COLOR_BGR2YUV_I420)
        encoded = self._encoder.encode(i420, int(captured_s * CLOCK_HZ), due)  # type: ignore[arg-type]
        if encoded.keyframe:
            self._keyframe_s = captured_s
        return encoded
