"""A chunk of actions at once, by flow matching: the baseline that one would pick today.

Lipman et al. (2022) and Liu et al. (2022): from noise x_0 to the demonstrated chunk x_1 on a straight line. The network
says where the line ends, and the velocity follows (x-prediction, Li and He, "Back to basics", 2025): of chunks of few
numbers that is the easier thing to learn.

    x_t = (1 - t) x_0 + t x_1,    loss = |f(x_t, t, o) - x_1|^2,    dx/dt = (f(x, t, o) - x) / (1 - t) at run time

Chunks as in Diffusion Policy (Chi et al., 2023): two observations in, `chunk` actions out, the first few are done.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor, nn

from mart.trainer.models.layers.stack import MLP, Generators, full

_TIME_FEATURES = 32
_FASTEST = 100.0  # the highest frequency that t is told in


class Flow(nn.Module):
    """Flows from noise to a chunk of actions, conditioned on observations."""

    def __init__(
        self,
        obs: Tensor,
        generators: Generators,
        *,
        size: int,
        chunk: int,
        hidden: Sequence[int],
        steps: int,
    ) -> None:
        """Condition on obs, bool[M, C], which say which columns are real. size: of one tick's action."""
        super().__init__()
        models = len(obs)
        self.chunk, self.size, self.steps = chunk, size, steps
        actions = full(models, chunk * size)
        inputs = torch.cat((obs, actions, full(models, _TIME_FEATURES)), 1)
        self.net = MLP(inputs, hidden, actions, generators)

    def forward(self, x: Tensor, t: Tensor, obs: Tensor) -> Tensor:
        """Return the chunk that x is on the way to: [M, B, chunk * size], as x is. t: [M, B, 1], obs: [M, B, C]."""
        return self.net(torch.cat((obs, x, _waves(t)), -1)).float()

    def loss(self, obs: Tensor, actions: Tensor, t: Tensor, noise: Tensor) -> Tensor:
        """Return the squared error for each tick of the chunk: [M, B, chunk].

        actions: [M, B, chunk * size]. t: [M, B] uniform. noise: like actions, standard normal.
        """
        t = t[..., None]
        error = self((1 - t) * noise + t * actions, t, obs) - actions
        return (error * error).unflatten(-1, (self.chunk, self.size)).mean(-1)

    def sample(self, obs: Tensor, noise: Tensor) -> Tensor:
        """Draw a chunk by Euler's method: [M, B, chunk, size] within [-1, 1]."""
        x = noise
        for step in range(self.steps):
            t = torch.full_like(x[..., :1], step / self.steps)
            x = x + (self(x, t, obs) - x) / (self.steps - step)
        return x.unflatten(-1, (self.chunk, self.size)).clamp(-1, 1)


def _waves(t: Tensor) -> Tensor:
    """Return sines and cosines of t, slow to fast: [M, B, 1] → [M, B, 32]."""
    half = _TIME_FEATURES // 2
    speeds = torch.exp(torch.linspace(0, math.log(_FASTEST), half, device=t.device))
    return torch.cat((torch.sin(t * speeds), torch.cos(t * speeds)), -1)
