"""A chunk of actions by a transformer: ACT, action chunking with transformers.

Zhao et al. (arXiv 2304.13705), of low-dimensional observations: a conditional variational autoencoder whose latent says
how the chunk is done, such as how fast, and is 0, its mean, at run time.

    posterior  q(z | a, o) = N(mu, sigma^2)       a transformer over a token of its own, observations and actions
    decoder    a' = f(z, o)                       queries, one for each tick, look at z and observations
    loss = |a' - a| + beta KL(q || N(0, 1))

Smaller than published, and normalised before each part instead of after it. The average of overlapping chunks at run
time ("temporal ensembling") is a choice of every model of chunks, `chunk_ensemble`.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from mart.trainer.models.layers.attention import Block, Norm, tokens
from mart.trainer.models.layers.chunks import HISTORY, ChunkModel
from mart.trainer.models.layers.stack import Generators, Linear, full
from mart.trainer.models.rng import Draws

_LOG_VARIANCE = (-8.0, 8.0)


@dataclass(frozen=True)
class TransformerSize:
    """How large it is. layers: of each of its three parts. kl_weight: beta."""

    width: int
    heads: int
    layers: int
    latent: int
    kl_weight: float


class ActionChunkingTransformer(ChunkModel):
    """A variational autoencoder of chunks of actions, made of transformers."""

    def __init__(
        self, obs: Tensor, generators: Generators, *, size: int, chunk: int, sizes: TransformerSize
    ) -> None:
        """Condition on obs, bool[M, HISTORY * width], which say which columns are real."""
        super().__init__(chunk, size)
        self.sizes, models, width = sizes, len(obs), sizes.width
        wide, latent, action = full(models, width), full(models, sizes.latent), full(models, size)
        self.observed = Linear(obs.chunk(HISTORY, 1)[0], wide, generators)
        self.acted = Linear(action, wide, generators)
        self.told = Linear(latent, wide, generators)
        self.summary = tokens(
            models, 1 + HISTORY + chunk, width, generators
        )  # its first token is summed up in
        self.places = tokens(models, 1 + HISTORY, width, generators)
        self.queries = tokens(models, chunk, width, generators)
        self.posterior, self.encoder = (self._blocks(models, generators) for _ in range(2))
        self.decoder = self._blocks(models, generators, with_memory=True)
        self.posterior_norm, self.memory_norm, self.last_norm = (Norm(models, width) for _ in range(3))
        self.code = Linear(wide, torch.cat((latent, latent), 1), generators)
        self.out = Linear(wide, action, generators)

    def loss(self, obs: Tensor, actions: Tensor, draws: Draws) -> Tensor:
        mean, log_variance = self._posterior(obs, actions)
        z = mean + torch.exp(0.5 * log_variance) * draws.normal(self.sizes.latent)
        divergence = 0.5 * (mean * mean + torch.exp(log_variance) - 1 - log_variance).sum(-1, keepdim=True)
        return self.per_tick((self.decode(z, obs) - actions).abs()) + self.sizes.kl_weight * divergence

    def sample(self, obs: Tensor, draws: Draws) -> Tensor:
        del draws
        return self.decode(obs.new_zeros(*obs.shape[:-1], self.sizes.latent), obs)

    def reconstruct(self, obs: Tensor, actions: Tensor, draws: Draws) -> Tensor:
        mean, log_variance = self._posterior(obs, actions)
        z = mean + torch.exp(0.5 * log_variance) * draws.normal(self.sizes.latent)
        return self.decode(z, obs)

    def decode(self, z: Tensor, obs: Tensor) -> Tensor:
        """Decode a latent. z: [M, B, latent], obs: [M, B, C] → a chunk, [M, B, chunk * size]."""
        memory = torch.cat((self.told(z)[:, :, None], self._seen(obs)), 2) + self.places
        for block in self.encoder:
            memory = block(memory)
        memory = self.memory_norm(memory)
        x = self.queries.expand(-1, obs.shape[1], -1, -1)
        for block in self.decoder:
            x = block(x, memory)
        flat = self.out(self.last_norm(x).flatten(1, 2))
        return flat.view(*obs.shape[:2], -1).float()

    def _posterior(self, obs: Tensor, actions: Tensor) -> tuple[Tensor, Tensor]:
        """Return mean and log variance of q(z | a, o), each [M, B, latent]."""
        done = self.acted(actions.unflatten(-1, (self.chunk, self.size)).flatten(1, 2))
        done = done.view(*actions.shape[:2], self.chunk, -1)
        start = torch.zeros_like(done[:, :, :1])
        x = torch.cat((start, self._seen(obs), done), 2) + self.summary
        for block in self.posterior:
            x = block(x)
        mean, log_variance = self.code(self.posterior_norm(x[:, :, :1])[:, :, 0]).float().chunk(2, -1)
        return mean, log_variance.clamp(*_LOG_VARIANCE)

    def _seen(self, obs: Tensor) -> Tensor:
        """Return a token for each observation: [M, B, C] → [M, B, HISTORY, W]."""
        each = obs.unflatten(-1, (HISTORY, -1))
        return self.observed(each.flatten(1, 2)).view(*each.shape[:3], -1)

    def _blocks(self, models: int, generators: Generators, *, with_memory: bool = False) -> nn.ModuleList:
        sizes = self.sizes
        return nn.ModuleList(
            Block(models, sizes.width, sizes.heads, generators, with_memory=with_memory)
            for _ in range(sizes.layers)
        )
