"""What models of chunks have in common: from what is seen, what to do in the next `chunk` ticks, all at once.

Chunks as in Diffusion Policy (Chi et al., 2023): two observations in, `chunk` actions out, the first few are done.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import torch
from torch import Tensor, nn

from mart.trainer.models.layers.stack import MLP, Generators, full
from mart.trainer.models.rng import Draws

HISTORY = 2  # observations that a chunk follows from
_TIME_FEATURES = 32
_FASTEST = 100.0  # the highest frequency that t is told in


class ChunkModel(nn.Module, ABC):
    """Says chunks of actions, normalised where they are. `size`: numbers of one tick's action.

    M models, B rows, C columns of observations.
    """

    def __init__(self, chunk: int, size: int) -> None:
        super().__init__()
        self.chunk, self.size = chunk, size

    @abstractmethod
    def loss(self, obs: Tensor, actions: Tensor, draws: Draws) -> Tensor:
        """Return the loss for each tick of the chunk: [M, B, chunk]. obs: [M, B, C]. actions: [M, B, chunk * size]."""

    @abstractmethod
    def sample(self, obs: Tensor, draws: Draws) -> Tensor:
        """Return a chunk to do: [M, B, chunk * size]. obs: [M, B, C]."""

    def reconstruct(self, obs: Tensor, actions: Tensor, draws: Draws) -> Tensor:
        """Return the chunk that it would have done where `actions` were demonstrated, as `sample` does.

        A model that can tell which of several ways was taken keeps to it; others do as in `sample`.
        """
        del actions
        return self.sample(obs, draws)

    def per_tick(self, error: Tensor) -> Tensor:
        """Average over the numbers of each tick: [M, B, chunk * size] → [M, B, chunk]."""
        return error.unflatten(-1, (self.chunk, self.size)).mean(-1)


class ChunkDenoiser(ChunkModel):
    """Makes chunks by improving worse ones: a perceptron f(x, t, o) of a chunk x, how far it is, and what is seen."""

    def __init__(
        self, obs: Tensor, generators: Generators, *, size: int, chunk: int, hidden: Sequence[int]
    ) -> None:
        """Condition on obs, bool[M, C], which say which columns are real."""
        super().__init__(chunk, size)
        actions = full(len(obs), chunk * size)
        inputs = torch.cat((obs, actions, full(len(obs), _TIME_FEATURES)), 1)
        self.net = MLP(inputs, hidden, actions, generators)

    def forward(self, x: Tensor, t: Tensor, obs: Tensor) -> Tensor:
        """Return a chunk: [M, B, chunk * size], as x is. t: [M, B, 1], obs: [M, B, C]."""
        return self.net(torch.cat((obs, x, _waves(t)), -1)).float()


def _waves(t: Tensor) -> Tensor:
    """Return sines and cosines of t, slow to fast: [M, B, 1] → [M, B, 32]."""
    half = _TIME_FEATURES // 2
    speeds = torch.exp(torch.linspace(0, math.log(_FASTEST), half, device=t.device))
    return torch.cat((torch.sin(t * speeds), torch.cos(t * speeds)), -1)
