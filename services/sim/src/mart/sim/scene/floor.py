"""Draw the floor: a tile of boards that repeats, and the rug on which table and arms stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mart.sim.scene.palette import rgba

TILE_M = 1.6
RUG_HALF_M = (1.30, 1.20)
_PIXELS = 256
_ROWS, _BOARDS_IN_ROW = 8, 2
_WOOD, _RUG, _WEAVE = (rgba(color)[:3] for color in ("#A3927C", "#56606B", "#8793A0"))
_JOINT_SHADE, _TONES = 0.84, 0.045


def boards() -> NDArray[np.uint8]:
    """Draw one tile, whose opposite edges fit: sRGB, shape (rows, columns, 3)."""
    random = np.random.default_rng(7)
    across, along = np.indices((_PIXELS, _PIXELS))
    height, length = _PIXELS // _ROWS, _PIXELS // _BOARDS_IN_ROW
    row = across // height
    shifted = (along + random.integers(0, _PIXELS, _ROWS)[row]) % _PIXELS
    tone = 1.0 + random.uniform(-_TONES, _TONES, (_ROWS, _BOARDS_IN_ROW))[row, shifted // length]
    joint = (across % height == 0) | (shifted % length == 0)
    return _image(_WOOD * (tone * _grain(random) * np.where(joint, _JOINT_SHADE, 1.0))[..., None])


def rug() -> NDArray[np.uint8]:
    """Draw the rug, its woven edge and the shade of what stands on it: sRGB, shape (rows, columns, 3)."""
    half_x, half_y = RUG_HALF_M
    x, y = np.meshgrid(np.linspace(-half_x, half_x, _PIXELS), np.linspace(half_y, -half_y, _PIXELS))
    from_edge = np.minimum(half_x - np.abs(x), half_y - np.abs(y))
    line = (np.abs(from_edge - 0.09) < 0.022) | (np.abs(from_edge - 0.16) < 0.008)
    shade = 1.0 - 0.5 * np.exp(-((x / 0.80) ** 4) - (y / 0.75) ** 4)
    return _image(np.where(line[..., None], _WEAVE, _RUG) * shade[..., None])


def _grain(random: np.random.Generator) -> NDArray[np.float64]:
    """Draw fine streaks along the boards, around 1."""
    spectrum = np.fft.rfft(random.standard_normal((_PIXELS, _PIXELS)), axis=1)
    spectrum[:, 10:] = 0.0
    streaks: NDArray[np.float64] = np.fft.irfft(spectrum, _PIXELS, axis=1)
    return 1.0 + 0.02 * streaks / streaks.std()


def _image(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    return (np.clip(shares, 0.0, 1.0) * 255).round().astype(np.uint8)
