"""Who sees what: from joint observations to the inputs of stacked models, and from their actions back.

With S seeds, a joint model is one unit a seed (M = S); a per-arm model is one unit an arm (M = S * arms, a seed's arms
beside each other). An arm that sees less than another is padded with zeros.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from mart.protocol.batch_state import ACTION_SIZE
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.models.architecture import Span


class ArmPartition(nn.Module):
    """How arms are parted among a model's units: one for all of them, or one an arm that sees its columns."""

    def __init__(self, layout: ObservationLayout, span: Span) -> None:
        super().__init__()
        columns = (
            [torch.arange(layout.width)]
            if span == "joint"
            else [torch.from_numpy(layout.columns_of(arm)) for arm in layout.arms]
        )
        self.units, self.width = len(columns), max(map(len, columns))
        self.arms = len(layout.arms) // self.units  # that a unit drives
        self.real = torch.arange(self.width) < torch.tensor(
            [[len(own)] for own in columns]
        )  # bool[units, width]
        self.index: Tensor
        padded = [torch.nn.functional.pad(own, (0, self.width - len(own)), value=-1) for own in columns]
        self.register_buffer("index", torch.stack(padded), persistent=False)

    @property
    def action_size(self) -> int:
        """How many numbers a unit's action has."""
        return self.arms * ACTION_SIZE

    def stacked(self, seeds: int) -> Tensor:
        """Return bool[M, width]: which columns are real."""
        return self.real.repeat(seeds, 1)

    def of(self, obs: Tensor) -> Tensor:
        """Return what each model sees of joint observations: [S, ..., D] → [M, ..., width]."""
        if self.units == 1:
            return obs
        taken = obs[..., self.index] * (self.index >= 0)
        return taken.movedim(-2, 1).flatten(0, 1)

    def split(self, actions: Tensor) -> Tensor:
        """Part joint actions among models: [S, ..., arms, 7] → [M, ..., action_size]."""
        return self.per_unit(actions.flatten(-2)).contiguous()

    def per_unit(self, values: Tensor) -> Tensor:
        """Part values by arm among models: [S, ..., arms * k] → [M, ..., k of each of the unit's arms]."""
        return values.unflatten(-1, (self.units, -1)).movedim(-2, 1).flatten(0, 1)

    def merge(self, actions: Tensor) -> Tensor:
        """Join the models' actions, the inverse of `split`: [M, ..., action_size] → [S, ..., arms, 7]."""
        joined = actions.unflatten(0, (-1, self.units)).movedim(1, -2)
        return joined.flatten(-2).unflatten(-1, (-1, ACTION_SIZE))
