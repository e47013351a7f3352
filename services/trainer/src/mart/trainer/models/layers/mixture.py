"""Mixtures of diagonal Gaussians, for many models at once.

    p(x) = sum_k w_k prod_d N(x_d; mean_kd, deviation_kd)

As torch.distributions' MixtureSameFamily(Categorical, Independent(Normal, 1)), which the tests compare it with.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

_LOG_ROOT_TAU = 0.5 * math.log(math.tau)


def log_normal(x: Tensor, mean: Tensor, deviation: Tensor) -> Tensor:
    """Return the log density of each component of x by itself."""
    return -0.5 * ((x - mean) / deviation) ** 2 - torch.log(deviation) - _LOG_ROOT_TAU


@dataclass(frozen=True)
class Mixture:
    """K Gaussians over D numbers. logits: [..., K], means and deviations: [..., K, D]."""

    logits: Tensor
    means: Tensor
    deviations: Tensor

    def log_prob(self, x: Tensor) -> Tensor:
        """Return the log density: x: [..., D] → [...]."""
        parts = log_normal(x[..., None, :], self.means, self.deviations).sum(-1)
        return torch.logsumexp(torch.log_softmax(self.logits, dim=-1) + parts, dim=-1)

    def sample(self, choice: Tensor, noise: Tensor) -> Tensor:
        """Draw a sample.

        choice: [...], uniform in [0, 1), picks the mode; noise: [..., D], standard normal → [..., D].
        """
        heights = torch.softmax(self.logits, dim=-1).cumsum(-1)
        mode = (choice[..., None] >= heights).sum(-1).clamp(max=self.logits.shape[-1] - 1)
        index = mode[..., None, None].expand(*mode.shape, 1, self.means.shape[-1])
        mean, deviation = (torch.gather(of, -2, index).squeeze(-2) for of in (self.means, self.deviations))
        return mean + deviation * noise
