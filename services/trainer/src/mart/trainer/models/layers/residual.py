"""A small correction of what a frozen policy would do.

The paper's equation (res): a = abar + delta, delta = rho(abar, s), |delta|_2 < epsilon. The bound holds by construction
for each arm by itself, so that tasks with two and three arms compare:

    delta = epsilon tanh(|u|) u / |u|

It is smooth, exactly 0 where u is, and its gradient never vanishes as a clip's does. The last layer starts at 0: until
it is trained, the corrected policy is the base, bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from mart.protocol.batch_state import ACTION_SIZE
from mart.trainer.models.layers.stack import MLP, Generators, full

_NO_LENGTH = 1e-8
_INSIDE = 1 - 2**-18  # tanh rounds to 1 where |u| is large; the bound is strict


def bounded(u: Tensor, epsilon: float) -> Tensor:
    """Shorten u, [..., 7], to less than epsilon; its direction stays."""
    length = torch.sqrt((u * u).sum(-1, keepdim=True) + _NO_LENGTH**2)
    return epsilon * _INSIDE * torch.tanh(length) * (u / length)


class Residual(nn.Module):
    """Corrects the action of a base by less than epsilon for each arm."""

    def __init__(
        self, obs: Tensor, generators: Generators, *, arms: int, hidden: Sequence[int], epsilon: float
    ) -> None:
        """Correct `arms` arms a model from obs, bool[M, D], which say which columns of observations are real."""
        super().__init__()
        models, size = len(obs), arms * ACTION_SIZE
        self.epsilon = epsilon
        self.net = MLP(torch.cat((obs, full(models, size)), 1), hidden, full(models, size), generators)
        self.net.last.zero()

    def forward(self, obs: Tensor, action: Tensor) -> Tensor:
        """Return the correction. obs: [M, B, D], the base's action: [M, B, arms * 7] → delta: [M, B, arms * 7]."""
        u = self.net(torch.cat((obs, action), -1)).float()
        return bounded(u.unflatten(-1, (-1, ACTION_SIZE)), self.epsilon).flatten(-2)
