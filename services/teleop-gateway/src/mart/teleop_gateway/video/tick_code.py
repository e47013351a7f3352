"""Write the tick into the picture and read it back: docs/protocol.md, "Tick code in the picture"."""

from __future__ import annotations

import numpy as np

from mart.render import Image

WIDTH_PX = 640
VIEW_HEIGHT_PX = 480
SQUARE_PX = 16
HEIGHT_PX = VIEW_HEIGHT_PX + SQUARE_PX

_BITS = 40
_CHECK = 0xA5
_THRESHOLD = 128
_PARTS = HEIGHT_PX // SQUARE_PX  # a picture is 31 squares high, and the strip is the last one


def write(tick: int, strip_rgb: Image) -> None:
    """Fill the strip, shape (16 k, 640 k, 3), with `tick` (its low 32 bits)."""
    word = tick & 0xFFFFFFFF
    code = word << 8 | _checksum(word)
    bits = np.array([code >> (_BITS - 1 - i) & 1 for i in range(_BITS)], dtype=np.uint8)
    strip_rgb[:] = np.repeat(bits * np.uint8(255), strip_rgb.shape[1] // _BITS)[np.newaxis, :, np.newaxis]


def read(luma: Image) -> int | None:
    """Return the tick in a whole frame's luma, shape (496 k, 640 k); None where the checksum is wrong."""
    height, square = luma.shape[0], luma.shape[1] // _BITS
    centres = np.arange(_BITS) * square + square // 2
    bits = luma[height - height // _PARTS // 2, centres] >= _THRESHOLD
    code = int("".join("1" if bit else "0" for bit in bits), 2)
    word = code >> 8
    return word if code & 0xFF == _checksum(word) else None


def _checksum(word: int) -> int:
    return word >> 24 ^ word >> 16 & 0xFF ^ word >> 8 & 0xFF ^ word & 0xFF ^ _CHECK
