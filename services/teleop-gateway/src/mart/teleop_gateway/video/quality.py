"""Say how pictures look, as data. The strip with the tick is part of every picture and grows with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

import numpy as np

from mart.render import Image

QualityName = Literal["fast", "full"]

_SQUARES = 40  # of the strip, side by side


@dataclass(frozen=True)
class Quality:
    """Say how large and how fine pictures are.

    `width_px` is a multiple of 80, also at every share of it that is drawn. `samples` a pixel smooth edges; `detailed`
    asks the room for detailed meshes.
    """

    width_px: int
    samples: int
    shadows: bool
    detailed: bool

    @property
    def view_height_px(self) -> int:
        """Return the height of the view, without the strip."""
        return self.width_px * 3 // 4

    @property
    def height_px(self) -> int:
        """Return the height of the picture, with the strip."""
        return self.view_height_px + self.width_px // _SQUARES

    def sized(self, share: Fraction) -> Quality:
        """Return the same quality at a share of the width."""
        return replace(self, width_px=int(self.width_px * share))

    def blank_picture(self) -> Image:
        """Return a black picture, shape (height_px, width_px, 3)."""
        return np.zeros((self.height_px, self.width_px, 3), np.uint8)


FAST = Quality(width_px=640, samples=0, shadows=False, detailed=False)
# 960 x 744 is the largest of these pictures that level 3.1 of H.264 allows at 20 and 30 ticks a second, which every
# browser decodes; at more the stream says the level that it needs.
FULL = Quality(width_px=960, samples=4, shadows=True, detailed=True)

QUALITIES: Mapping[QualityName, Quality] = {"fast": FAST, "full": FULL}
