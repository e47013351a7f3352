"""The planner: a conditional variational autoencoder that says what will be seen `window` ticks from now.

Kingma and Welling (2013), conditioned as in IRIS (Mandlekar et al., 2020), with a learned mixture as prior:

    posterior q(z | g, o) = N(mu, sigma^2)       encoder, of the subgoal g and the observation o
    prior     p(z | o)    = sum_k w_k N(m_k, s_k^2)
    decoder   g' = f(z, o)
    loss = recon(g', g) + beta E_q[log q(z | g, o) - log p(z | o)]

Subgoals are predicted as differences from what is seen now, since most of what will be seen in half a second is there
already. The expectation is of one sample: the divergence from a mixture has no closed form. recon is the squared error,
averaged over each named observation and then over their names, as in robomimic: a gripper weighs as much as a pose. The
divergence is computed in float32 whatever the products run in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from mart.trainer.models.layers.mixture import Mixture, log_normal
from mart.trainer.models.layers.stack import MLP, Generators, full

_LOG_VARIANCE = (-8.0, 30.0)  # robomimic's clamp
_NO_WEIGHT = 1e-8


@dataclass(frozen=True)
class PlannerLoss:
    """What the planner minimises; each [M, B]."""

    reconstruction: Tensor
    divergence: Tensor


class Planner(nn.Module):
    """Draws subgoals: what should be seen `window` ticks from now."""

    def __init__(
        self,
        real: Tensor,
        weights: Tensor,
        generators: Generators,
        *,
        hidden: Sequence[int],
        latent: int,
        modes: int,
    ) -> None:
        """Plan for real columns, bool[M, D]. weights: float32[M, D], of each in the reconstruction; sum 1."""
        super().__init__()
        models = len(real)
        self.latent, self.modes = latent, modes
        self.weights: Tensor
        self.register_buffer("weights", weights, persistent=False)
        code = full(models, latent)
        self.encoder = MLP(torch.cat((real, real), 1), hidden, torch.cat((code, code), 1), generators)
        self.decoder = MLP(torch.cat((code, real), 1), hidden, real, generators)
        self.prior = MLP(real, hidden, full(models, modes * (1 + 2 * latent)), generators)

    def loss(self, obs: Tensor, goal: Tensor, noise: Tensor, told: Tensor | None = None) -> PlannerLoss:
        """Return the losses. obs, goal: [M, B, D]. noise: [M, B, latent], standard normal.

        told: bool[M, B, D], the columns of the goal that are to be reconstructed; all of them.
        """
        mean, deviation = self._posterior(obs, goal)
        z = mean + deviation * noise
        error = self.decode(z, obs) - goal
        divergence = log_normal(z, mean, deviation).sum(-1) - self.prior_of(obs).log_prob(z)
        weights = self.weights[:, None]
        if told is not None:
            weights = weights * told
            weights = weights / weights.sum(-1, keepdim=True).clamp(min=_NO_WEIGHT)
        return PlannerLoss((weights * error * error).sum(-1), divergence)

    def prior_of(self, obs: Tensor) -> Mixture:
        """Return the prior p(z | o). obs: [M, B, D]."""
        parameters = self.prior(obs).float()
        logits, rest = parameters[..., : self.modes], parameters[..., self.modes :]
        means, log_variances = rest.unflatten(-1, (self.modes, 2 * self.latent)).chunk(2, dim=-1)
        return Mixture(logits, means, torch.exp(0.5 * log_variances.clamp(*_LOG_VARIANCE)))

    def decode(self, z: Tensor, obs: Tensor) -> Tensor:
        """Decode a latent. z: [M, B, latent], obs: [M, B, D] → subgoal [M, B, D]."""
        return obs + self.decoder(torch.cat((z, obs), -1)).float()

    def reconstruct(self, obs: Tensor, goal: Tensor, noise: Tensor) -> Tensor:
        """Encode `goal`, draw from the posterior and decode: [M, B, D], as in `loss`."""
        mean, deviation = self._posterior(obs, goal)
        return self.decode(mean + deviation * noise, obs)

    def _posterior(self, obs: Tensor, goal: Tensor) -> tuple[Tensor, Tensor]:
        """Return mean and deviation of q(z | g, o), each [M, B, latent]."""
        mean, log_variance = self.encoder(torch.cat((goal, obs), -1)).float().chunk(2, dim=-1)
        return mean, torch.exp(0.5 * log_variance.clamp(*_LOG_VARIANCE))

    def sample(self, obs: Tensor, choice: Tensor, noise: Tensor) -> Tensor:
        """Draw a subgoal from the prior. choice: [M, B] uniform, noise: [M, B, latent] normal → [M, B, D]."""
        return self.decode(self.prior_of(obs).sample(choice, noise), obs)
