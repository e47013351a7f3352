"""An exponential moving average of weights (Polyak and Juditsky, 1992), which acts in their place."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor


class EMA:
    """The exponential moving average of `weights`; `decay` is how much of it stays at each update."""

    def __init__(self, weights: Mapping[str, Tensor], decay: float) -> None:
        self._weights, self._decay = list(weights.values()), decay
        self.values = {name: weight.detach().clone() for name, weight in weights.items()}

    @torch.no_grad()
    def update(self, number: int) -> None:
        """Move towards the weights after update `number`, from 1; while young it forgets its beginning faster."""
        decay = min(self._decay, number / (number + 10))
        for value, weight in zip(self.values.values(), self._weights, strict=True):
            value.lerp_(weight, 1 - decay)
