"""The planner's loss against torch.distributions."""

from __future__ import annotations

import torch
from torch.distributions import Categorical, Independent, MixtureSameFamily, Normal

from mart.trainer.models.layers.stack import full
from mart.trainer.models.layers.vae import Planner

MODELS, BATCH, SIZE, LATENT, MODES = 2, 64, 5, 3, 4


def _planner() -> Planner:
    generators = [torch.Generator().manual_seed(m) for m in range(MODELS)]
    real, weights = full(MODELS, SIZE), torch.full((MODELS, SIZE), 1 / SIZE)
    return Planner(real, weights, generators, hidden=(8,), latent=LATENT, modes=MODES)


def test_the_loss_is_what_torchs_distributions_say() -> None:
    planner = _planner()
    seen, goal = torch.randn(MODELS, BATCH, SIZE), torch.randn(MODELS, BATCH, SIZE)
    noise = torch.randn(MODELS, BATCH, LATENT)
    loss = planner.loss(seen, goal, noise)
    mean, log_variance = planner.encoder(torch.cat((goal, seen), -1)).chunk(2, -1)
    posterior = Independent(Normal(mean, torch.exp(0.5 * log_variance)), 1)
    z = mean + torch.exp(0.5 * log_variance) * noise
    mixture = planner.prior_of(seen)
    prior = MixtureSameFamily(
        Categorical(logits=mixture.logits), Independent(Normal(mixture.means, mixture.deviations), 1)
    )
    torch.testing.assert_close(loss.divergence, posterior.log_prob(z) - prior.log_prob(z))
    error = planner.decode(z, seen) - goal
    torch.testing.assert_close(loss.reconstruction, (error**2).mean(-1))


def test_the_divergence_is_positive_on_average() -> None:
    planner = _planner()
    seen, goal = torch.randn(MODELS, 1, SIZE), torch.randn(MODELS, 1, SIZE)
    shape = MODELS, 20_000, SIZE
    loss = planner.loss(seen.expand(shape), goal.expand(shape), torch.randn(MODELS, 20_000, LATENT))
    assert (loss.divergence.mean(1) > -0.01).all()


def test_every_part_gets_a_gradient() -> None:
    planner = _planner()
    x = torch.randn(MODELS, BATCH, SIZE)
    loss = planner.loss(x, torch.randn_like(x), torch.randn(MODELS, BATCH, LATENT))
    (loss.reconstruction + loss.divergence).mean().backward()
    assert all(w.grad is not None and w.grad.abs().sum() > 0 for w in planner.parameters())
