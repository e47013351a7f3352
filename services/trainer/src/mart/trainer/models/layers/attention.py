"""Transformer layers of many models of one shape (Vaswani et al., 2017), normalised before each part.

    attention(x, y) = softmax(Q K^T / sqrt(d)) V W_o,    Q = x W_q + b_q,  K = y W_k,  V = y W_v + b_v

Keys have no bias: it would add the same to all of a row's logits, and change nothing.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn.functional import scaled_dot_product_attention

from mart.trainer.models.layers.stack import MLP, Generators, Linear, full, uniform

_WIDER = 4  # the perceptron between attentions, in widths
_LEAST_VARIANCE = 1e-5


class Norm(nn.Module):
    """Normalises each token to mean 0 and deviation 1, then scales and shifts: [M, B, T, W] → [M, B, T, W]."""

    def __init__(self, models: int, width: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.ones(models, 1, 1, width))
        self.bias = nn.Parameter(torch.zeros(models, 1, 1, width))

    def forward(self, x: Tensor) -> Tensor:
        normal = torch.nn.functional.layer_norm(x.float(), x.shape[-1:], eps=_LEAST_VARIANCE)
        return normal * self.weight + self.bias


class Attention(nn.Module):
    """Attention of several heads, from tokens to tokens: [M, B, T, W] and [M, B, T', W] → [M, B, T, W]."""

    def __init__(self, models: int, width: int, heads: int, generators: Generators) -> None:
        super().__init__()
        self.heads, all_of_it = heads, full(models, width)
        self.query = Linear(all_of_it, all_of_it, generators)
        self.key = uniform(all_of_it, all_of_it, all_of_it.sum(1), generators)
        self.value = Linear(all_of_it, all_of_it, generators)
        self.out = Linear(all_of_it, all_of_it, generators)

    def forward(self, x: Tensor, of: Tensor) -> Tensor:
        query, value = self.query(x.flatten(1, 2)), self.value(of.flatten(1, 2))
        key = torch.bmm(of.flatten(1, 2), self.key)
        found = scaled_dot_product_attention(
            self._parted(query, x), self._parted(key, of), self._parted(value, of)
        )
        joined = found.unflatten(0, x.shape[:2]).transpose(2, 3).flatten(-2)
        return self.out(joined.flatten(1, 2)).view(x.shape)

    def _parted(self, flat: Tensor, tokens: Tensor) -> Tensor:
        """Part by heads: [M, B * T, W] → [M * B, heads, T, W / heads]."""
        return flat.view(*tokens.shape[:3], self.heads, -1).flatten(0, 1).transpose(1, 2)


class Block(nn.Module):
    """Attention among tokens, to a memory where there is one, and a perceptron, each added to what was there."""

    def __init__(
        self, models: int, width: int, heads: int, generators: Generators, *, with_memory: bool = False
    ) -> None:
        super().__init__()
        self.own = Attention(models, width, heads, generators)
        self.own_norm, self.mlp_norm = Norm(models, width), Norm(models, width)
        wide = full(models, width)
        self.mlp = MLP(wide, (_WIDER * width,), wide, generators)
        if with_memory:
            self.memory = Attention(models, width, heads, generators)
            self.memory_norm = Norm(models, width)

    def forward(self, x: Tensor, memory: Tensor | None = None) -> Tensor:
        """Let tokens look. x: [M, B, T, W], memory: [M, B, T', W] → [M, B, T, W]."""
        normal = self.own_norm(x)
        x = x + self.own(normal, normal)
        if memory is not None:
            x = x + self.memory(self.memory_norm(x), memory)
        return x + self.mlp(self.mlp_norm(x))


def tokens(models: int, count: int, width: int, generators: Generators) -> nn.Parameter:
    """Draw `count` tokens to learn: float32[M, 1, count, width], normal with deviation 0.02."""
    drawn = [torch.randn(1, count, width, generator=own) * 0.02 for own in generators]
    assert len(drawn) == models
    return nn.Parameter(torch.stack(drawn))
