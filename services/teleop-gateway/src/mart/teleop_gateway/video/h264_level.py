"""Say which level of H.264 (ITU-T H.264, table A-1) pictures of a size and rate need: what a decoder keeps up with."""

from __future__ import annotations

import math

_MACROBLOCK_PX = 16
# Level (as 10 times its number): macroblocks a second, macroblocks a picture. 3.1 is what every browser decodes.
_LEVELS = {
    31: (108_000, 3_600),
    32: (216_000, 5_120),
    40: (245_760, 8_192),
    42: (522_240, 8_704),
    50: (589_824, 22_080),
    51: (983_040, 36_864),
    52: (2_073_600, 36_864),
}


def h264_level(width_px: int, height_px: int, frames_per_s: float) -> int:
    """Return the smallest level from 3.1 on, times 10, that allows these pictures; the largest where none does."""
    macroblocks = math.ceil(width_px / _MACROBLOCK_PX) * math.ceil(height_px / _MACROBLOCK_PX)
    for level, (most_a_second, most_a_picture) in _LEVELS.items():
        if macroblocks <= most_a_picture and macroblocks * frames_per_s <= most_a_second:
            return level
    return max(_LEVELS)
