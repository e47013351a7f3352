"""A chunk of actions by diffusion, as Karras et al. (2022, "EDM") set it up.

    x = a + sigma z,    D(x, sigma, o) = c_skip x + c_out f(c_in x, c_noise, o),    loss = |D - a|^2 / c_out^2
    c_skip = d^2 / (sigma^2 + d^2)    c_out = sigma d / sqrt(sigma^2 + d^2)    c_in = 1 / sqrt(sigma^2 + d^2)
    c_noise = ln(sigma) / 4           ln sigma ~ N(-1.2, 1.2^2) while learning
    dx/dsigma = (x - D(x, sigma, o)) / sigma at run time, by Euler's method from sigma = 50 to 0.001, then D

d is the deviation of the actions. One for each arm, trained together, is MIMIC-D (Dong et al., arXiv 2509.14159): its
centralised objective is the sum of the arms' losses, each of which sees its arm's observations alone. The networks
share no weight, so the sum's gradient is each one's own: trained together or apart, they learn the same but for the
clip of the gradient's length over all arms in its published code, which is left out here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor

from mart.trainer.models.layers.chunks import ChunkDenoiser
from mart.trainer.models.layers.stack import Generators
from mart.trainer.models.rng import Draws

_DEVIATION = 0.5  # of actions, which lie within [-1, 1]
_LOG_MEAN, _LOG_DEVIATION = -1.2, 1.2
_MOST, _LEAST, _BEND = 50.0, 0.001, 7.0  # noise at run time, and how its steps crowd where there is little


class Diffusion(ChunkDenoiser):
    """Removes noise from a chunk of actions, conditioned on observations, in `steps` steps."""

    def __init__(
        self,
        obs: Tensor,
        generators: Generators,
        *,
        size: int,
        chunk: int,
        hidden: Sequence[int],
        steps: int,
    ) -> None:
        super().__init__(obs, generators, size=size, chunk=chunk, hidden=hidden)
        self.steps = steps

    def denoise(self, x: Tensor, sigma: Tensor, obs: Tensor) -> Tensor:
        """Return the expected chunk behind the noise. x: [M, B, chunk * size], sigma: [M, B, 1], obs: [M, B, C]."""
        length = torch.sqrt(sigma * sigma + _DEVIATION**2)
        said = self(x / length, torch.log(sigma) / 4, obs)
        return (_DEVIATION / length) ** 2 * x + sigma * _DEVIATION / length * said

    def loss(self, obs: Tensor, actions: Tensor, draws: Draws) -> Tensor:
        sigma = torch.exp(_LOG_MEAN + _LOG_DEVIATION * draws.normal(1))
        error = self.denoise(actions + sigma * draws.normal(actions.shape[-1]), sigma, obs) - actions
        c_out = sigma * _DEVIATION / torch.sqrt(sigma * sigma + _DEVIATION**2)
        return self.per_tick((error / c_out) ** 2)

    def sample(self, obs: Tensor, draws: Draws) -> Tensor:
        levels = noise_levels(self.steps)
        x = levels[0] * draws.normal(self.chunk * self.size)
        for now, after in zip(levels, (*levels[1:], 0.0), strict=True):
            end = self.denoise(x, torch.full_like(x[..., :1], now), obs)
            x = end + (x - end) * (after / now)
        return x


def noise_levels(steps: int) -> list[float]:
    """Return the noise before each of `steps` steps, falling: evenly spaced in the seventh root."""
    most, least = _MOST ** (1 / _BEND), _LEAST ** (1 / _BEND)
    parts = [i / max(1, steps - 1) for i in range(steps)]
    return [math.pow(most + part * (least - most), _BEND) for part in parts]
