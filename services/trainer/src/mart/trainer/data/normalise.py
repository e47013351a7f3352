"""Numbers as networks take them: mean 0 and deviation 1 over the data."""

from __future__ import annotations

import torch
from torch import Tensor, nn

_LEAST_DEVIATION = 0.02  # of what hardly moves (metres, radians, parts of 1): noise is not blown up
_FARTHEST = 10.0  # deviations: what was never seen like that is told as "far"


class Normaliser(nn.Module):
    """Saved with the weights: a policy sees what its networks saw. One for all seeds."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.mean: Tensor
        self.deviation: Tensor
        self.register_buffer("mean", torch.zeros(width))
        self.register_buffer("deviation", torch.ones(width))

    def fit(self, rows: Tensor) -> None:
        """Take mean and deviation from rows, [N, D]."""
        rows = rows.double()
        self.mean.copy_(rows.mean(0))
        self.deviation.copy_(rows.std(0, correction=0).clamp(min=_LEAST_DEVIATION))

    def forward(self, values: Tensor) -> Tensor:
        """Normalise: [..., D] → [..., D]."""
        return ((values - self.mean) / self.deviation).clamp(-_FARTHEST, _FARTHEST)

    def restore(self, values: Tensor) -> Tensor:
        """Return what `forward` normalised: [..., D] → [..., D]."""
        return values * self.deviation + self.mean
