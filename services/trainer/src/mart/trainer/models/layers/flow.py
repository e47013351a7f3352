"""A chunk of actions by flow matching.

Lipman et al. (2022) and Liu et al. (2022): from noise x_0 to the demonstrated chunk x_1 on a straight line. The network
says where the line ends, and the velocity follows (x-prediction, Li and He, "Back to basics", 2025): of chunks of few
numbers that is the easier thing to learn.

    x_t = (1 - t) x_0 + t x_1,    loss = |f(x_t, t, o) - x_1|^2,    dx/dt = (f(x, t, o) - x) / (1 - t) at run time
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from mart.trainer.models.layers.chunks import ChunkDenoiser
from mart.trainer.models.layers.stack import Generators
from mart.trainer.models.rng import Draws


class Flow(ChunkDenoiser):
    """Flows from noise to a chunk of actions, conditioned on observations, in `steps` steps of Euler's method."""

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
        super().__init__(obs, generators, size=size, chunk=chunk, hidden=hidden)
        self.steps = steps

    def loss(self, obs: Tensor, actions: Tensor, draws: Draws) -> Tensor:
        t = draws.uniform()[..., None]
        noise = draws.normal(actions.shape[-1])
        error = self((1 - t) * noise + t * actions, t, obs) - actions
        return self.per_tick(error * error)

    def sample(self, obs: Tensor, draws: Draws) -> Tensor:
        x = draws.normal(self.chunk * self.size)
        for step in range(self.steps):
            t = torch.full_like(x[..., :1], step / self.steps)
            x = x + (self(x, t, obs) - x) / (self.steps - step)
        return x
