"""The correction is always shorter than epsilon, and nothing before it is trained."""

from __future__ import annotations

import math

import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.trainer.models.layers.residual import Residual, bounded
from mart.trainer.models.layers.stack import full

_numbers = st.floats(-1e6, 1e6, width=32)


@settings(max_examples=200)
@given(st.lists(_numbers, min_size=7, max_size=7), st.floats(1e-3, 10))
def test_it_is_strictly_shorter_than_epsilon(u: list[float], epsilon: float) -> None:
    delta = bounded(torch.tensor(u), epsilon)
    assert math.sqrt(sum(float(x) ** 2 for x in delta)) < epsilon


@settings(max_examples=50)
@given(st.lists(st.floats(-3, 3, width=32), min_size=7, max_size=7))
def test_its_gradient_is_finite_everywhere(u: list[float]) -> None:
    x = torch.tensor(u, requires_grad=True)
    bounded(x, 0.2).sum().backward()
    assert x.grad is not None
    assert torch.isfinite(x.grad).all()


def test_untrained_it_changes_nothing_but_learns() -> None:
    generators = [torch.Generator().manual_seed(0)]
    residual = Residual(full(1, 4), generators, arms=2, hidden=(8,), epsilon=0.2)
    seen, action = torch.randn(1, 5, 4), torch.randn(1, 5, 14)
    delta = residual(seen, action)
    assert (delta == 0).all()
    delta.sum().backward()
    assert residual.net.last.weight.grad.abs().sum() > 0
