"""Layers of many models of one shape, computed together: every tensor has a leading model axis M.

Models never meet: row m of an output depends on row m of input and weights alone, so the sum of their losses has the
gradients of each. A model's first weights come from its own generator, so it starts and ends the same whatever it is
stacked with. Models whose inputs or outputs are narrower than the others' are padded with zeros; a mask says which
columns are real, and the padded weights are zero and stay so.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor, nn

Generators = Sequence[torch.Generator]


def full(models: int, width: int) -> Tensor:
    """Return bool[M, width]: a mask of columns that are all real."""
    return torch.ones(models, width, dtype=torch.bool)


def uniform(rows: Tensor, columns: Tensor, fan_in: Tensor, generators: Generators) -> nn.Parameter:
    """Draw weights float32[M, I, O], uniform in +-1/sqrt(fan_in) where row and column are real and 0 elsewhere.

    rows: bool[M, I]. columns: bool[M, O]. fan_in: int[M]. As torch.nn.Linear and torch.nn.LSTM begin.
    """
    weight = torch.zeros(*rows.shape, columns.shape[1])
    for m, generator in enumerate(generators):
        bound = float(fan_in[m]) ** -0.5
        real = rows[m][:, None] & columns[m]
        count = int(real.sum())
        weight[m][real] = torch.empty(count).uniform_(-bound, bound, generator=generator)
    return nn.Parameter(weight)


class Linear(nn.Module):
    """A linear layer, y = x W + b, for every model: [M, B, I] → [M, B, O]."""

    def __init__(self, inputs: Tensor, outputs: Tensor, generators: Generators) -> None:
        """Map inputs, bool[M, I], to outputs, bool[M, O]: both say which columns are real."""
        super().__init__()
        fan_in = inputs.sum(1)
        self.weight = uniform(inputs, outputs, fan_in, generators)
        self.bias = uniform(full(len(inputs), 1), outputs, fan_in, generators)

    def forward(self, x: Tensor) -> Tensor:
        return torch.baddbmm(self.bias, x, self.weight)

    def zero(self) -> None:
        """Makes it answer 0 to everything, until it is trained."""
        nn.init.zeros_(self.weight)
        nn.init.zeros_(self.bias)


class MLP(nn.Module):
    """Linear layers with ReLU between them: [M, ..., I] → [M, ..., O]."""

    def __init__(
        self, inputs: Tensor, hidden: Sequence[int], outputs: Tensor, generators: Generators
    ) -> None:
        super().__init__()
        masks = [inputs, *(full(len(inputs), width) for width in hidden), outputs]
        self.layers = nn.ModuleList(Linear(i, o, generators) for i, o in itertools.pairwise(masks))

    def forward(self, x: Tensor) -> Tensor:
        shape, y = x.shape, x.flatten(1, -2)
        for layer in self.layers[:-1]:
            y = torch.relu(layer(y))
        return self.last(y).view(*shape[:-1], -1)

    @property
    def last(self) -> Any:
        """The last layer, a Linear."""
        return self.layers[-1]
