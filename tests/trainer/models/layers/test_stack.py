"""Models that are stacked never meet, and begin as they would alone."""

from __future__ import annotations

import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.trainer.models.layers.stack import MLP, Linear, full

_sizes = st.integers(1, 6)


def _generator(model: int) -> torch.Generator:
    return torch.Generator().manual_seed(100 + model)


@settings(max_examples=20)
@given(st.integers(1, 4), _sizes, _sizes, st.integers(1, 5))
def test_shapes(models: int, inputs: int, outputs: int, batch: int) -> None:
    net = MLP(full(models, inputs), (5, 4), full(models, outputs), [_generator(m) for m in range(models)])
    assert net(torch.randn(models, batch, inputs)).shape == (models, batch, outputs)
    assert net(torch.randn(models, 2, batch, inputs)).shape == (models, 2, batch, outputs)


@settings(max_examples=20)
@given(st.integers(2, 4), _sizes, _sizes)
def test_each_begins_and_answers_as_alone(models: int, inputs: int, outputs: int) -> None:
    x = torch.randn(models, 3, inputs)
    together = Linear(full(models, inputs), full(models, outputs), [_generator(m) for m in range(models)])
    for m in range(models):
        alone = Linear(full(1, inputs), full(1, outputs), [_generator(m)])
        assert torch.equal(alone.weight[0], together.weight[m])
        torch.testing.assert_close(alone(x[m : m + 1])[0], together(x)[m])


def test_a_models_loss_moves_no_other_model() -> None:
    net = MLP(full(3, 4), (5,), full(3, 2), [_generator(m) for m in range(3)])
    net(torch.randn(3, 6, 4))[1].square().sum().backward()
    for weight in net.parameters():
        assert weight.grad is not None
        moved = weight.grad.flatten(1).abs().sum(1) > 0
        assert moved.tolist() == [False, True, False]


def test_columns_that_are_not_real_have_no_weight_and_get_none() -> None:
    narrow = torch.tensor([[True, True, False], [True, True, True]])
    net = MLP(narrow, (4,), narrow, [_generator(0), _generator(1)])
    x = torch.randn(2, 8, 3) * narrow[:, None]
    alone = MLP(full(1, 2), (4,), full(1, 2), [_generator(0)])
    torch.testing.assert_close(net(x)[0, :, :2], alone(x[:1, :, :2])[0])
    assert (net(x)[0, :, 2] == 0).all()
    ((net(x) - x) ** 2).sum().backward()
    first, last = (weight.grad for name, weight in net.named_parameters() if name.endswith("weight"))
    assert first is not None
    assert (first[0, 2] == 0).all()
    assert last is not None
    assert (last[0, :, 2] == 0).all()
