from __future__ import annotations

import cv2
import numpy as np

from mart.teleop_gateway.video.thumbnail import EVERY_S, ThumbnailMaker


def test_it_is_the_picture_made_small() -> None:
    view_rgb = np.zeros((480, 640, 3), np.uint8)
    view_rgb[:, :320] = (200, 30, 30)
    thumbnail = ThumbnailMaker().take(view_rgb, 7, 100.0)
    assert thumbnail is not None
    assert thumbnail.image_ns == 7
    seen_bgr = cv2.imdecode(np.frombuffer(thumbnail.jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert seen_bgr is not None
    assert seen_bgr.shape == (288, 384, 3)
    assert np.allclose(seen_bgr[140, 50, ::-1], (200, 30, 30), atol=6)
    assert np.allclose(seen_bgr[140, 330], 0, atol=6)


def test_one_is_made_every_two_seconds() -> None:
    thumbnails, view_rgb = ThumbnailMaker(), np.zeros((240, 320, 3), np.uint8)
    made_s = [
        now_s for now_s in np.arange(0.0, 10.0, 0.05) if thumbnails.take(view_rgb, 0, now_s) is not None
    ]
    assert len(made_s) == 5
    assert np.all(np.diff(made_s) >= EVERY_S - 1e-9)
