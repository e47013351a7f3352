"""From a point of the grid to its networks and to the windows that they learn from."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import nn

from mart.trainer.data.layout import Layout
from mart.trainer.data.normalise import Normaliser
from mart.trainer.data.windows import Shape
from mart.trainer.grid import Model
from mart.trainer.nets.chunks import Chunks
from mart.trainer.nets.family import Hierarchy
from mart.trainer.presets import Hyperparameters


class Networks(nn.Module):
    """What a checkpoint's weights belong to: the model of every seed, and how observations are normalised."""

    def __init__(
        self,
        model: Model,
        layout: Layout,
        sizes: Hyperparameters,
        seeds: Sequence[int],
        dtype: torch.dtype = torch.float32,
    ) -> None:
        """`dtype`: of an LSTM's matrix products while training."""
        super().__init__()
        self.normaliser = Normaliser(layout.width)
        self.model: Hierarchy | Chunks = (
            Chunks(model, layout, sizes, seeds)
            if model.network == "flow"
            else Hierarchy(model, layout, sizes, seeds, dtype)
        )


def window_shape(model: Model, sizes: Hyperparameters) -> Shape:
    return Shape.chunk(sizes.flow_chunk) if model.network == "flow" else Shape.sequence(sizes.window)
