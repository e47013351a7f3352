"""Mixtures against torch.distributions."""

from __future__ import annotations

import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch.distributions import Categorical, Independent, MixtureSameFamily, Normal

from mart.trainer.models.layers.mixture import Mixture


def _mixture(batch: int, modes: int, size: int, seed: int) -> tuple[Mixture, MixtureSameFamily]:
    generator = torch.Generator().manual_seed(seed)
    logits = torch.randn(batch, modes, generator=generator)
    means = torch.randn(batch, modes, size, generator=generator)
    deviations = torch.rand(batch, modes, size, generator=generator) + 0.1
    theirs = MixtureSameFamily(Categorical(logits=logits), Independent(Normal(means, deviations), 1))
    return Mixture(logits, means, deviations), theirs


@settings(max_examples=25)
@given(st.integers(1, 4), st.integers(1, 6), st.integers(1, 5), st.integers(0, 2**20))
def test_the_density_is_torchs(batch: int, modes: int, size: int, seed: int) -> None:
    mine, theirs = _mixture(batch, modes, size, seed)
    x = torch.randn(batch, size)
    torch.testing.assert_close(mine.log_prob(x), theirs.log_prob(x))


def test_samples_have_the_mixtures_mean_and_spread() -> None:
    mine, theirs = _mixture(1, 3, 2, 5)
    count, generator = 20_000, torch.Generator().manual_seed(0)
    many = Mixture(*(t.expand(count, *t.shape[1:]) for t in (mine.logits, mine.means, mine.deviations)))
    drawn = many.sample(torch.rand(count, generator=generator), torch.randn(count, 2, generator=generator))
    torch.testing.assert_close(drawn.mean(0), theirs.mean[0], atol=0.05, rtol=0.05)
    torch.testing.assert_close(drawn.var(0), theirs.variance[0], atol=0.05, rtol=0.05)


@settings(max_examples=25)
@given(st.floats(0, 1, exclude_max=True), st.integers(1, 5))
def test_every_choice_picks_a_mode(choice: float, modes: int) -> None:
    mine, _ = _mixture(1, modes, 2, 1)
    drawn = mine.sample(torch.tensor([choice]), torch.zeros(1, 2))
    assert (drawn == mine.means[0]).all(-1).any()
