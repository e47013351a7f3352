"""What corrects a policy, of all arms at once or of each by itself, and what it learns."""

from __future__ import annotations

from collections.abc import Sequence

from torch import Tensor

from mart.protocol.batch_state import ACTION_SIZE
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.models.architecture import Span
from mart.trainer.models.arm_partition import ArmPartition
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.models.layers.residual import Residual
from mart.trainer.models.losses import Losses
from mart.trainer.models.rng import weight_generators


class ArmResidual(Residual):
    """A residual that sees what all arms see and corrects them together, or one for each arm."""

    def __init__(
        self, layout: ObservationLayout, span: Span, sizes: Hyperparameters, seeds: Sequence[int]
    ) -> None:
        partition = ArmPartition(layout, span)
        super().__init__(
            partition.stacked(len(seeds)),
            weight_generators(seeds, partition.units, "residual"),
            arms=partition.arms,
            hidden=sizes.residual_hidden,
            epsilon=sizes.residual_epsilon,
        )
        self.partition = partition

    @classmethod
    def of(
        cls, layout: ObservationLayout, span: Span, sizes: Hyperparameters, seeds: Sequence[int]
    ) -> ArmResidual | None:
        """Return the residual of a model; None of one that has none."""
        return None if span == "none" else cls(layout, span, sizes, seeds)

    def corrected(self, obs: Tensor, actions: Tensor) -> Tensor:
        """Return the base's actions, corrected. obs: [S, B, D], actions: [S, B, arms, 7]."""
        partition = self.partition
        return actions + partition.merge(self(partition.of(obs), partition.split(actions)))

    def losses(self, obs: Tensor, base: Tensor, actions: Tensor, weights: Tensor | None) -> Losses:
        """Return the losses of one batch, given what the frozen base does.

        obs: [S, T, B, D]. base, actions: [S, T, B, arms, 7], the latter as demonstrated. weights: [S, T, B, arms].
        """
        partition = self.partition
        done = partition.split(base)
        delta = self(partition.of(obs), done)
        each = ((done + delta - partition.split(actions)) ** 2).mean(-1)
        if weights is not None:
            each = each * partition.per_unit(weights).mean(-1)
        length = delta.detach().unflatten(-1, (-1, ACTION_SIZE)).norm(dim=-1)
        looks = {
            "base": ((base - actions) ** 2).flatten(1).mean(1),
            "correction": length.flatten(1).mean(1),
            "correction_at_bound": (length > 0.95 * self.epsilon).float().flatten(1).mean(1),
        }
        return Losses({"residual": each.flatten(1).mean(1)}, looks)
