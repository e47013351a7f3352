"""Build the networks of a point of the grid, and the windows that they learn from."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import nn

from mart.protocol.errors import InvalidInput
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.normalise import Normaliser
from mart.trainer.data.tool_targets import ToolTargets
from mart.trainer.data.windows import WindowSpec
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.chunk_policy_net import ChunkPolicyNet
from mart.trainer.models.hierarchical_bc import HierarchicalBC
from mart.trainer.models.hyperparameters import Hyperparameters


class Networks(nn.Module):
    """What a checkpoint's weights belong to: the model of every seed, and how observations are normalised."""

    def __init__(
        self,
        model: ModelSpec,
        layout: ObservationLayout,
        sizes: Hyperparameters,
        seeds: Sequence[int],
        dtype: torch.dtype = torch.float32,
    ) -> None:
        """Make untrained networks. dtype: of an LSTM's matrix products while training."""
        super().__init__()
        self.normaliser = Normaliser(layout.width)
        self.model: HierarchicalBC | ChunkPolicyNet = (
            ChunkPolicyNet(model, layout, sizes, seeds)
            if model.is_chunked
            else HierarchicalBC(model, layout, sizes, seeds, dtype)
        )


def window_spec(model: ModelSpec, sizes: Hyperparameters) -> WindowSpec:
    """Return which ticks of a window a model learns from."""
    if not model.is_chunked:
        return WindowSpec.sequence(sizes.window)
    return WindowSpec.chunk(sizes.chunk, 1 if model.residual == "none" else sizes.executed)


def tool_targets(
    model: ModelSpec, sizes: Hyperparameters, task: str, layout: ObservationLayout, arm_kinds: Sequence[str]
) -> ToolTargets | None:
    """Return how a model's actions are told as absolute targets; None where they are the steps that were recorded.

    Raises InvalidInput for a model that cannot have them.
    """
    if sizes.action_target == "delta":
        return None
    if not model.is_chunked or model.residual != "none":
        raise InvalidInput(
            f"action_target=absolute was given for {model.name}; only models of chunks without a residual have it."
        )
    return ToolTargets(task, layout, arm_kinds)
