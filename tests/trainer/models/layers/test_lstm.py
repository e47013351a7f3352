"""The stacked LSTM against torch.nn.LSTM, forward and backward, and alone against stacked."""

from __future__ import annotations

import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor, nn

from mart.trainer.models.layers.lstm import LSTM
from mart.trainer.models.layers.stack import full

_widths = st.integers(1, 7)


def _generators(models: int) -> list[torch.Generator]:
    return [torch.Generator().manual_seed(m) for m in range(models)]


def _stacked(models: int, inputs: int, width: int, layers: int) -> LSTM:
    return LSTM(full(models, inputs), width, layers, _generators(models), torch.float32)


def _torch_twin(lstm: LSTM, model: int) -> nn.LSTM:
    """torch has i, f, g, o where this has i, f, o, u, and two biases."""
    twin = nn.LSTM(lstm.w_i[0].shape[1], lstm.width, len(lstm.w_h), batch_first=True)
    h = lstm.width
    order = torch.cat([torch.arange(0, 2 * h), torch.arange(3 * h, 4 * h), torch.arange(2 * h, 3 * h)])
    with torch.no_grad():
        for layer in range(len(lstm.w_h)):
            getattr(twin, f"weight_ih_l{layer}").copy_(lstm.w_i[layer][model].mT[order])
            getattr(twin, f"weight_hh_l{layer}").copy_(lstm.w_h[layer][model].mT[order])
            getattr(twin, f"bias_ih_l{layer}").copy_(lstm.b[layer][model, 0, order])
            getattr(twin, f"bias_hh_l{layer}").zero_()
    return twin


@settings(max_examples=15)
@given(
    models=st.integers(1, 3),
    inputs=_widths,
    width=_widths,
    layers=st.integers(1, 3),
    ticks=st.integers(1, 6),
    batch=st.integers(1, 4),
)
def test_it_is_torchs_lstm_forward_and_backward(
    *, models: int, inputs: int, width: int, layers: int, ticks: int, batch: int
) -> None:
    lstm = _stacked(models, inputs, width, layers)
    x = torch.randn(models, ticks, batch, inputs, requires_grad=True)
    out = lstm(x)
    wanted = torch.randn_like(out)
    (out * wanted).sum().backward()
    for m in range(models):
        twin = _torch_twin(lstm, m)
        own = x.detach()[m].movedim(0, 1).contiguous().requires_grad_()
        expected, _ = twin(own)
        (expected.movedim(1, 0) * wanted[m]).sum().backward()
        torch.testing.assert_close(out[m], expected.movedim(1, 0))
        torch.testing.assert_close(_grad(x)[m], _grad(own).movedim(1, 0))
        _same_gradients(lstm, m, twin)


def _same_gradients(lstm: LSTM, model: int, twin: nn.LSTM) -> None:
    h = lstm.width
    back = torch.cat([torch.arange(0, 2 * h), torch.arange(3 * h, 4 * h), torch.arange(2 * h, 3 * h)])
    for layer in range(len(lstm.w_h)):
        pairs = {"weight_ih": lstm.w_i, "weight_hh": lstm.w_h}
        for name, weights in pairs.items():
            theirs = _grad(getattr(twin, f"{name}_l{layer}"))[back].mT
            torch.testing.assert_close(_grad(weights[layer])[model], theirs, atol=1e-5, rtol=1e-4)
        theirs = _grad(getattr(twin, f"bias_ih_l{layer}"))[back]
        torch.testing.assert_close(_grad(lstm.b[layer])[model, 0], theirs, atol=1e-5, rtol=1e-4)


@settings(max_examples=10)
@given(_widths, _widths, st.integers(1, 3), st.integers(1, 6))
def test_tick_by_tick_it_does_the_same(inputs: int, width: int, layers: int, ticks: int) -> None:
    lstm = _stacked(2, inputs, width, layers)
    x = torch.randn(2, ticks, 3, inputs)
    memory, steps = lstm.start(3), []
    for t in range(ticks):
        out, memory = lstm.step(x[:, t], memory)
        steps.append(out)
    torch.testing.assert_close(torch.stack(steps, 1), lstm(x))


def test_bfloat16_products_stay_close() -> None:
    generators = _generators(2)
    exact = _stacked(2, 5, 8, 2)
    rough = LSTM(full(2, 5), 8, 2, generators, torch.bfloat16)
    x = torch.randn(2, 10, 4, 5)
    torch.testing.assert_close(rough(x), exact(x), atol=0.03, rtol=0.1)


def _grad(tensor: Tensor) -> Tensor:
    assert tensor.grad is not None
    return tensor.grad
