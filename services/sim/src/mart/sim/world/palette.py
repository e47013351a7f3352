"""Colours of the scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def rgba(color: str, alpha: float = 1.0) -> NDArray[np.float64]:
    """`#RRGGBB` as four numbers in [0, 1]."""
    return np.array([*(int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)), alpha])
