"""The baseline's networks: chunks of actions by flow matching, of all arms at once or of each by itself."""

from __future__ import annotations

from collections.abc import Sequence

from torch import Tensor, nn

from mart.trainer.data.layout import Layout
from mart.trainer.data.windows import Batch
from mart.trainer.grid import Model
from mart.trainer.nets.family import Losses, generators
from mart.trainer.nets.flow import Flow
from mart.trainer.nets.views import View
from mart.trainer.noise import Noise
from mart.trainer.presets import Hyperparameters

HISTORY = 2  # observations that a chunk follows from


class Chunks(nn.Module):
    def __init__(self, model: Model, layout: Layout, sizes: Hyperparameters, seeds: Sequence[int]) -> None:
        super().__init__()
        self.view = View(layout, model.actor)
        self.flow = Flow(
            self.view.stacked(len(seeds)).repeat(1, HISTORY),
            generators(seeds, self.view.units, "flow"),
            size=self.view.action_size,
            chunk=sizes.flow_chunk,
            hidden=sizes.flow_hidden,
            steps=sizes.flow_steps,
        )

    def base_losses(self, batch: Batch, noise: Noise) -> Losses:
        view, windows = self.view, batch.seen.shape[2]
        actions = view.split(batch.actions).movedim(1, 2)
        t = noise.uniform(view.units, windows)
        drawn = noise.normal(view.units, windows, self.flow.chunk * self.flow.size)
        each = self.flow.loss(self._condition(batch.seen), actions.flatten(2), t, drawn)
        if batch.weights is not None:
            each = each * view.per_unit(batch.weights).mean(-1).movedim(1, 2)
        return Losses({"actor": each.flatten(1).mean(1)}, {})

    def chunk(self, seen: Tensor, noise: Noise) -> Tensor:
        """seen: [S, 2, B, D], older first → [S, chunk, B, arms, 7]."""
        drawn = noise.normal(self.view.units, seen.shape[2], self.flow.chunk * self.flow.size)
        return self.view.merge(self.flow.sample(self._condition(seen), drawn).movedim(2, 1))

    def _condition(self, seen: Tensor) -> Tensor:
        """[S, 2, B, D] → [M, B, 2 * width]."""
        return self.view.of(seen).movedim(1, 2).flatten(2)
