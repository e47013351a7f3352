"""The networks of a policy that acts in chunks, for many seeds at once.

    chunk    (a_0, a_1 …) ~ model(o_-1, o_0)      every `chunk_execute` ticks
    result   a_k + residual(o_k, a_k)             every tick, where there is a residual

The residual is trained after the base, which is frozen then, at every tick that is done of the base's own chunk: on
o_k as it was demonstrated and a_k as the base put it k ticks before, which is where the two drift apart. Where the
base can tell which of several ways was taken, its chunk is that way's (decisions 0024 and 0093).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import torch
from torch import Tensor, nn

from mart.protocol.batch_state import ACTION_SIZE
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.normalise import Normaliser
from mart.trainer.data.windows import WindowBatch
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.arm_partition import ArmPartition
from mart.trainer.models.arm_residual import ArmResidual
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.models.layers.act import ActionChunkingTransformer, TransformerSize
from mart.trainer.models.layers.chunks import HISTORY, ChunkModel
from mart.trainer.models.layers.diffusion import Diffusion
from mart.trainer.models.layers.flow import Flow
from mart.trainer.models.layers.two_step import TwoStep
from mart.trainer.models.losses import Losses
from mart.trainer.models.rng import Draws, Rng, weight_generators


class ChunkPolicyNet(nn.Module):
    """A model of chunks, of all arms at once or of each by itself, and a residual or none."""

    def __init__(
        self, model: ModelSpec, layout: ObservationLayout, sizes: Hyperparameters, seeds: Sequence[int]
    ) -> None:
        super().__init__()
        self.model, self.executed = model, sizes.executed
        self.scale = Normaliser(len(layout.arms) * ACTION_SIZE) if sizes.normalise_actions else None
        self.partition = ArmPartition(layout, model.actor)
        self.add_module(model.network, _chunk_model(model, self.partition, sizes, seeds))
        self.residual = ArmResidual.of(layout, model.residual, sizes, seeds)

    @property
    def chunks(self) -> ChunkModel:
        """What says the chunks; its weights are kept under the network's own name."""
        return cast("ChunkModel", self.get_submodule(self.model.network))

    def base_losses(self, batch: WindowBatch, rng: Rng) -> Losses:
        """Return the losses of one batch."""
        each = self.chunks.loss(*self._demonstrated(batch), self._draws(batch.obs.shape[2], rng))
        if batch.weights is not None:
            each = each * self.partition.per_unit(batch.weights).mean(-1).movedim(1, 2)
        return Losses({"actor": each.flatten(1).mean(1)}, {})

    def residual_losses(self, batch: WindowBatch, rng: Rng) -> Losses:
        """Return the losses of the residual; the base is frozen and does a chunk of its own."""
        assert self.residual is not None
        with torch.no_grad():
            done = self.chunks.reconstruct(*self._demonstrated(batch), self._draws(batch.obs.shape[2], rng))
            base = self._by_tick(done)[:, : self.executed]
        now = batch.obs[:, HISTORY - 1 : HISTORY - 1 + self.executed]
        weights = None if batch.weights is None else batch.weights[:, : self.executed]
        return self.residual.losses(now, base, batch.actions[:, : self.executed], weights)

    def chunk(self, obs: Tensor, rng: Rng) -> Tensor:
        """Return a chunk of the base's actions. obs: [S, 2, B, D], older first → [S, chunk, B, arms, 7]."""
        return self._by_tick(self.chunks.sample(self._condition(obs), self._draws(obs.shape[2], rng)))

    def corrected(self, obs: Tensor, actions: Tensor) -> Tensor:
        """Return what is done in a tick. obs: [S, B, D], the base's actions: [S, B, arms, 7] → the same, in [-1, 1]."""
        return actions if self.residual is None else self.residual.corrected(obs, actions).clamp(-1, 1)

    def _demonstrated(self, batch: WindowBatch) -> tuple[Tensor, Tensor]:
        """Return what is seen, [M, B, 2 * width], and what was done then, [M, B, chunk * action size]."""
        flat = batch.actions.flatten(-2)
        actions = self.partition.per_unit(flat if self.scale is None else self.scale(flat)).movedim(1, 2)
        return self._condition(batch.obs[:, :HISTORY]), actions.flatten(2)

    def _condition(self, obs: Tensor) -> Tensor:
        """Lay two observations side by side: [S, 2, B, D] → [M, B, 2 * width]."""
        return self.partition.of(obs).movedim(1, 2).flatten(2)

    def _by_tick(self, chunk: Tensor) -> Tensor:
        """Join the models' chunks: [M, B, chunk * action size] → [S, chunk, B, arms, 7] in [-1, 1]."""
        joined = self.partition.merge(chunk.unflatten(-1, (self.chunks.chunk, -1)).movedim(2, 1))
        if self.scale is not None:
            joined = self.scale.restore(joined.flatten(-2)).view_as(joined)
        return joined.clamp(-1, 1)

    def _draws(self, batch: int, rng: Rng) -> Draws:
        return Draws(rng, self.partition.units, batch)


def _chunk_model(
    model: ModelSpec, partition: ArmPartition, sizes: Hyperparameters, seeds: Sequence[int]
) -> ChunkModel:
    obs = partition.stacked(len(seeds)).repeat(1, HISTORY)
    own = weight_generators(seeds, partition.units, model.network)
    size, chunk, hidden, steps = partition.action_size, sizes.chunk, sizes.chunk_hidden, sizes.chunk_steps
    match model.network:
        case "flow":
            return Flow(obs, own, size=size, chunk=chunk, hidden=hidden, steps=steps)
        case "mip":
            return TwoStep(obs, own, size=size, chunk=chunk, hidden=hidden)
        case "diffusion":
            return Diffusion(obs, own, size=size, chunk=chunk, hidden=hidden, steps=steps)
        case _:
            large = TransformerSize(
                width=sizes.act_width,
                heads=sizes.act_heads,
                layers=sizes.act_layers,
                latent=sizes.act_latent,
                kl_weight=sizes.act_kl_weight,
            )
            return ActionChunkingTransformer(obs, own, size=size, chunk=chunk, sizes=large)
