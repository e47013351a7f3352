"""What an actor ends in: from features to an action, and how far it was from the one that was demonstrated."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn.functional import softplus

from mart.trainer.models.layers.mixture import Mixture
from mart.trainer.models.layers.stack import Generators, Linear, full

_LEAST_DEVIATION = 1e-4  # robomimic's; also what it acts with (low_noise_eval)


class MeanHead(nn.Module):
    """The mean action, squashed into (-1, 1) by tanh: the paper's objective |pi(s) - a|^2."""

    def __init__(self, features: Tensor, size: int, generators: Generators) -> None:
        """Make a head for features, bool[M, F], which say which columns are real."""
        super().__init__()
        self.out = Linear(features, full(len(features), size), generators)

    def forward(self, features: Tensor) -> Tensor:
        """Return the mean action: [M, B, F] → [M, B, A]."""
        return torch.tanh(self.out(features).float())

    def loss(self, features: Tensor, action: Tensor, counted: Tensor | None = None) -> Tensor:
        """Return the squared error, averaged over the action's numbers: [M, B]. counted: [M, B, A], of each; 1 each."""
        errors = (self(features) - action) ** 2
        return (errors if counted is None else errors * counted).mean(-1)

    def act(self, features: Tensor, choice: Tensor, noise: Tensor) -> Tensor:
        """Return the mean action, [M, B, A]; nothing is drawn."""
        del choice, noise
        return self(features)


class MixtureHead(nn.Module):
    """A mixture of Gaussians over all the action's numbers, means in (-1, 1): what people do is not one thing."""

    def __init__(self, features: Tensor, size: int, modes: int, generators: Generators) -> None:
        super().__init__()
        self.size, self.modes = size, modes
        self.out = Linear(features, full(len(features), modes * (1 + 2 * size)), generators)

    def forward(self, features: Tensor) -> Mixture:
        """Return the mixture of each: features [M, B, F]."""
        parameters = self.out(features).float()
        logits, rest = parameters[..., : self.modes], parameters[..., self.modes :]
        means, spreads = rest.unflatten(-1, (self.modes, 2 * self.size)).chunk(2, dim=-1)
        return Mixture(logits, torch.tanh(means), softplus(spreads) + _LEAST_DEVIATION)

    def loss(self, features: Tensor, action: Tensor, counted: Tensor | None = None) -> Tensor:
        """Return the negative log likelihood: [M, B]. It is of the whole action: parts cannot count alone."""
        assert counted is None
        return -self(features).log_prob(action)

    def act(self, features: Tensor, choice: Tensor, noise: Tensor) -> Tensor:
        """Draw an action near the mean of a mode that is drawn: [M, B, A].

        choice: [M, B] uniform, noise: [M, B, A] normal.
        """
        mixture = self(features)
        still = Mixture(mixture.logits, mixture.means, torch.full_like(mixture.deviations, _LEAST_DEVIATION))
        return still.sample(choice, noise)
