"""The baseline's networks: chunks of actions by flow matching, of all arms at once or of each by itself."""

from __future__ import annotations

from collections.abc import Sequence

from torch import Tensor, nn

from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.windows import WindowBatch
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.arm_partition import ArmPartition
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.models.layers.flow import Flow
from mart.trainer.models.losses import Losses
from mart.trainer.models.rng import Rng, weight_generators

HISTORY = 2  # observations that a chunk follows from


class FlowPolicyNet(nn.Module):
    """A flow of action chunks, of all arms at once or of each by itself."""

    def __init__(
        self, model: ModelSpec, layout: ObservationLayout, sizes: Hyperparameters, seeds: Sequence[int]
    ) -> None:
        super().__init__()
        self.partition = ArmPartition(layout, model.actor)
        self.flow = Flow(
            self.partition.stacked(len(seeds)).repeat(1, HISTORY),
            weight_generators(seeds, self.partition.units, "flow"),
            size=self.partition.action_size,
            chunk=sizes.flow_chunk,
            hidden=sizes.flow_hidden,
            steps=sizes.flow_steps,
        )

    def base_losses(self, batch: WindowBatch, rng: Rng) -> Losses:
        """Return the losses of one batch."""
        partition, windows = self.partition, batch.obs.shape[2]
        actions = partition.split(batch.actions).movedim(1, 2)
        t = rng.uniform(partition.units, windows)
        drawn = rng.normal(partition.units, windows, self.flow.chunk * self.flow.size)
        each = self.flow.loss(self._condition(batch.obs), actions.flatten(2), t, drawn)
        if batch.weights is not None:
            each = each * partition.per_unit(batch.weights).mean(-1).movedim(1, 2)
        return Losses({"actor": each.flatten(1).mean(1)}, {})

    def chunk(self, obs: Tensor, rng: Rng) -> Tensor:
        """Draw a chunk of actions. obs: [S, 2, B, D], older first → [S, chunk, B, arms, 7]."""
        drawn = rng.normal(self.partition.units, obs.shape[2], self.flow.chunk * self.flow.size)
        return self.partition.merge(self.flow.sample(self._condition(obs), drawn).movedim(2, 1))

    def _condition(self, obs: Tensor) -> Tensor:
        """Lay two observations side by side: [S, 2, B, D] → [M, B, 2 * width]."""
        return self.partition.of(obs).movedim(1, 2).flatten(2)
