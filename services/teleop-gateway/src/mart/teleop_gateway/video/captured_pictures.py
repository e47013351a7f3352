"""Fit captured pictures into seats' pictures, whole, with black bars where their shapes differ; read their JPEGs."""

from __future__ import annotations

import cv2
import numpy as np

from mart.protocol.errors import Corrupt
from mart.render import Image

PICTURES_PER_S = 30.0  # of a camera, at most
MAX_JPEG_BYTES = 4 * 1024 * 1024
_MAX_PIXELS = 1920 * 1488  # more than any quality asks for
_FRAME_HEADERS = (0xC0, 0xC1, 0xC2)  # of the JPEGs that there are: baseline, extended, progressive
_ALONE = range(0xD0, 0xD9)  # markers without a length


def fit_into(picture: Image, out: Image) -> None:
    """Fill `out`, shape (rows, columns, 3), with all of `picture`, as large as it fits."""
    rows, columns = out.shape[:2]
    scale = min(rows / picture.shape[0], columns / picture.shape[1])
    height = max(1, min(rows, round(picture.shape[0] * scale)))
    width = max(1, min(columns, round(picture.shape[1] * scale)))
    top, left = (rows - height) // 2, (columns - width) // 2
    if (height, width) != (rows, columns):
        out[:] = 0
    target = out[top : top + height, left : left + width]
    if picture.shape[:2] == (height, width):
        target[:] = picture
    else:
        how = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
        target[:] = cv2.resize(picture, (width, height), interpolation=how)


def decode_picture(jpeg: bytes) -> Image:
    """Return a camera's JPEG as RGB, shape (rows, columns, 3). Raises Corrupt where it is none, or too large."""
    pixels = _pixels(jpeg)
    picture = None
    if 0 < pixels <= _MAX_PIXELS and len(jpeg) <= MAX_JPEG_BYTES:
        picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR_RGB)
    if picture is None:
        raise Corrupt("A picture of a camera was given that is no JPEG of a size that seats show.")
    return picture  # type: ignore[return-value]


def _pixels(jpeg: bytes) -> int:
    """Return how many pixels a JPEG's frame header tells (ITU-T T.81, B.2.2); 0 where there is none."""
    at = 2
    while at + 9 <= len(jpeg) and jpeg[at] == 0xFF:
        if jpeg[at + 1] in _FRAME_HEADERS:
            rows, columns = (int.from_bytes(jpeg[i : i + 2], "big") for i in (at + 5, at + 7))
            return rows * columns
        at += 2 if jpeg[at + 1] in _ALONE else 2 + int.from_bytes(jpeg[at + 2 : at + 4], "big")
    return 0
