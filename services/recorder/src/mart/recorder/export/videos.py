"""Write pictures as H.264 in MP4, picture k at k / fps exactly, and count their colours."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from mart.recorder.export.cameras import CameraRequest

# A key frame every second picture: training takes pictures at random, and each is decoded from the key frame before.
_EVERY = 2
_OPTIONS = {"crf": "20", "preset": "veryfast", "bf": "0"}
_LEVELS = 256

Histogram = NDArray[np.int64]  # how many pixels have a level, shape (3, 256)


def write_video(
    path: Path, pictures: Iterable[NDArray[np.uint8]], camera: CameraRequest, fps: int
) -> Histogram:
    """Write the file, one picture in memory at a time, and return how often each level of red, green and blue is."""
    counts = np.zeros((3, _LEVELS), np.int64)
    with av.open(str(path), "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=fps, options=dict(_OPTIONS))
        stream.width, stream.height, stream.pix_fmt = camera.width_px, camera.height_px, "yuv420p"
        stream.gop_size = _EVERY
        stream.codec_context.time_base = Fraction(1, fps)
        stream.codec_context.thread_count = 1  # the episodes beside have the other cores
        for number, picture in enumerate(_counted(pictures, counts)):
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            frame.pts, frame.time_base = number, Fraction(1, fps)
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return counts


def video_info(camera: CameraRequest, fps: int) -> dict[str, object]:
    """Say what the video is, in LeRobot's words: the same of every data set, or its tools merge none."""
    return {
        "video.height": camera.height_px,
        "video.width": camera.width_px,
        "video.codec": "h264",
        "video.pix_fmt": "yuv420p",
        "video.is_depth_map": False,
        "video.fps": fps,
        "video.channels": 3,
        "has_audio": False,
    }


def _counted(pictures: Iterable[NDArray[np.uint8]], counts: Histogram) -> Iterator[NDArray[np.uint8]]:
    for picture in pictures:
        for channel in range(3):
            counts[channel] += np.bincount(picture[..., channel].ravel(), minlength=_LEVELS)
        yield picture
