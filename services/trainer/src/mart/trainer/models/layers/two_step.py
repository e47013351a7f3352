"""A chunk of actions by regression in two steps: MIP, the minimal iterative policy.

Pan et al., "Much Ado About Noising" (arXiv 2512.01809): what makes flows good at control is that they compute in steps
whose middle is supervised and noisy, not that they draw. Two steps and no draw at run time are enough:

    loss = |f(0, 0, o) - a|^2 + |f(a + (1 - t) z, t, o) - a|^2,    z ~ N(0, 1),  t = 0.9
    at run time   a_1 = f(0, 0, o),   a_2 = f(a_1, t, o)

The first step is the mean of what was demonstrated, the second learns to correct a chunk that is nearly right. As in
the authors' code, the second is given the first's answer whole; the paper's equations scale it by t. Their code weighs
the errors by 1 / t^2 and 1 / (1 - t)^2; here, as in the paper's equation, they count the same.
"""

from __future__ import annotations

import torch
from torch import Tensor

from mart.trainer.models.layers.chunks import ChunkDenoiser
from mart.trainer.models.rng import Draws

SECOND = 0.9  # the t of the second step


class TwoStep(ChunkDenoiser):
    """Regresses a chunk of actions, then regresses again from its own answer."""

    def loss(self, obs: Tensor, actions: Tensor, draws: Draws) -> Tensor:
        noisy = actions + (1 - SECOND) * draws.normal(actions.shape[-1])
        first = self._step(torch.zeros_like(actions), 0.0, obs) - actions
        second = self._step(noisy, SECOND, obs) - actions
        return self.per_tick(first * first + second * second)

    def sample(self, obs: Tensor, draws: Draws) -> Tensor:
        del draws
        nothing = obs.new_zeros(*obs.shape[:-1], self.chunk * self.size)
        return self._step(self._step(nothing, 0.0, obs), SECOND, obs)

    def _step(self, x: Tensor, t: float, obs: Tensor) -> Tensor:
        return self(x, torch.full_like(x[..., :1], t), obs)
