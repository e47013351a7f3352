"""What one update of stacked models minimises, and what it tells beside."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class Losses:
    """Losses of one update. `terms`: by name, each [M], to be minimised; `diagnostics`: by name, numbers to look at."""

    terms: dict[str, Tensor]
    diagnostics: dict[str, Tensor]

    @property
    def total(self) -> Tensor:
        """Sum of all terms. Models never meet, so the gradient of the sum is that of each."""
        return torch.stack([loss.sum() for loss in self.terms.values()]).sum()
