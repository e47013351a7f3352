"""A stacked LSTM with its backward pass written out.

Hochreiter and Schmidhuber (1997) with forget gates (Gers et al., 2000), as torch.nn.LSTM defines it, but one bias:

    z_t = x_t W_i + h_{t-1} W_h + b            columns of z: the gates i, f, o and the candidate u
    c_t = f_t c_{t-1} + i_t u_t                i, f, o = sigmoid(z), u = tanh(z)
    h_t = o_t tanh(c_t)

torch.nn.LSTM has no model axis, and torch.func.vmap does not reach into it. Left to autograd, the loop would add up the
gradient of W_h tick by tick; written out, it is one product over all ticks. Matrix products run in `dtype`, bfloat16
where the processor has it; gates and cells stay in float32.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor, nn

from mart.trainer.models.layers.stack import Generators, full, uniform

LSTMState = tuple[Tensor, Tensor]  # h and c, each float32[M, B, H]


def squash_(z: Tensor) -> Tensor:
    """Apply, in place, sigmoid to the three gates and tanh to the candidate. z: [M, B, 4 H]."""
    width = z.shape[-1] // 4
    z[..., : 3 * width].sigmoid_()
    z[..., 3 * width :].tanh_()
    return z


class _Layer(torch.autograd.Function):
    """One layer over T ticks from a state of zeros. x: [M, T, B, I] → h: float32[M, T, B, H]."""

    @staticmethod
    def forward(  # noqa: PLR0917 -- autograd passes them by position
        ctx: Any, x: Tensor, w_i: Tensor, w_h: Tensor, b: Tensor, dtype: torch.dtype
    ) -> Tensor:
        models, ticks, batch, _ = x.shape
        width = w_h.shape[1]
        x, w_i, w_h = x.to(dtype), w_i.to(dtype), w_h.to(dtype)
        z = torch.bmm(x.flatten(1, 2), w_i).view(models, ticks, batch, 4 * width)
        gates = torch.empty_like(z, dtype=torch.float32)
        cells = gates.new_zeros(models, ticks + 1, batch, width)  # cells[:, t]: before tick t
        shown = torch.empty_like(cells[:, 1:])  # tanh of the cells after each tick
        hidden = torch.zeros_like(cells, dtype=dtype)
        out = torch.empty_like(shown)
        for t in range(ticks):
            z_t = torch.baddbmm(z[:, t], hidden[:, t], w_h) if t else z[:, t]
            i, f, o, u = squash_(torch.add(z_t, b, out=gates[:, t])).chunk(4, dim=-1)
            torch.mul(f, cells[:, t], out=cells[:, t + 1]).addcmul_(i, u)
            torch.mul(o, torch.tanh(cells[:, t + 1], out=shown[:, t]), out=out[:, t])
            hidden[:, t + 1] = out[:, t]
        ctx.save_for_backward(x, w_i, w_h, gates, cells, shown, hidden)
        return out

    @staticmethod
    def backward(ctx: Any, *d_out: Tensor) -> tuple[Tensor | None, Tensor, Tensor, Tensor, None]:
        x, w_i, w_h, gates, cells, shown, hidden = ctx.saved_tensors
        d_z, d = torch.empty_like(gates, dtype=x.dtype), torch.empty_like(gates[:, 0])
        d_h, d_c = torch.zeros_like(cells[:, 0]), torch.zeros_like(cells[:, 0])
        for t in reversed(range(x.shape[1])):
            d_h = d_h + d_out[0][:, t]
            _tick_backward(gates[:, t], cells[:, t], shown[:, t], d_h, d_c, d)
            d_z[:, t] = d
            if t:
                d_h = torch.bmm(d_z[:, t], w_h.mT).float()
        flat = d_z.flatten(1, 2)
        d_x = torch.bmm(flat, w_i.mT).view(x.shape).float() if ctx.needs_input_grad[0] else None
        d_w_i = torch.bmm(x.flatten(1, 2).mT, flat).float()
        d_w_h = torch.bmm(hidden[:, 1:-1].flatten(1, 2).mT, d_z[:, 1:].flatten(1, 2)).float()
        return d_x, d_w_i, d_w_h, flat.float().sum(1, keepdim=True), None


def _tick_backward(  # noqa: PLR0917 -- tensors of one tick, in the order of the equations
    gates: Tensor, before: Tensor, shown: Tensor, d_h: Tensor, d_c: Tensor, d_z: Tensor
) -> None:
    """Fills d_z with the gradient to z, and turns d_c from that to the cell after the tick into that to the one before.

    before: the cell before the tick. shown: tanh of the one after. d_h: the gradient to h.
    """
    i, f, o, u = gates.chunk(4, dim=-1)
    d_i, d_f, d_o, d_u = d_z.chunk(4, dim=-1)
    d_c += torch.ops.aten.tanh_backward(d_h * o, shown)
    for product, left, right in ((d_i, d_c, u), (d_f, d_c, before), (d_o, d_h, shown), (d_u, d_c, i)):
        torch.mul(left, right, out=product)
    three = 3 * u.shape[-1]
    d_z[..., :three] = torch.ops.aten.sigmoid_backward(d_z[..., :three], gates[..., :three])
    d_z[..., three:] = torch.ops.aten.tanh_backward(d_u, u)
    d_c *= f


class LSTM(nn.Module):
    """Layers of equal width. `dtype`: of the matrix products while training."""

    def __init__(
        self, inputs: Tensor, width: int, layers: int, generators: Generators, dtype: torch.dtype
    ) -> None:
        """Make layers for inputs, bool[M, I], which say which columns are real."""
        super().__init__()
        self.width, self.dtype = width, dtype
        models = len(inputs)
        outputs, fan = full(models, 4 * width), torch.full((models,), width)
        rows = [inputs, *(full(models, width) for _ in range(layers - 1))]
        self.w_i = nn.ParameterList(uniform(real, outputs, fan, generators) for real in rows)
        self.w_h = nn.ParameterList(uniform(full(models, width), outputs, fan, generators) for _ in rows)
        self.b = nn.ParameterList(uniform(full(models, 1), outputs, fan, generators) for _ in rows)

    def forward(self, x: Tensor) -> Tensor:
        """Run over T ticks from a state of zeros. x: [M, T, B, I] → [M, T, B, H]."""
        for w_i, w_h, b in zip(self.w_i, self.w_h, self.b, strict=True):
            x = _Layer.apply(x, w_i, w_h, b, self.dtype)  # type: ignore[no-untyped-call]
        return x

    def start(self, batch: int) -> list[LSTMState]:
        """Return a state of zeros for each layer."""
        zeros = self.b[0].new_zeros(len(self.b[0]), batch, self.width)
        return [(zeros, zeros) for _ in self.w_h]

    def step(self, x: Tensor, state: Sequence[LSTMState]) -> tuple[Tensor, list[LSTMState]]:
        """Run one tick in float32. x: [M, B, I] → h of the last layer, and the next state."""
        after = []
        for w_i, w_h, b, (h, c) in zip(self.w_i, self.w_h, self.b, state, strict=True):
            i, f, o, u = squash_(torch.bmm(x, w_i) + torch.bmm(h, w_h) + b).chunk(4, dim=-1)
            c_after = f * c + i * u
            x = o * torch.tanh(c_after)
            after.append((x, c_after))
        return x, after
