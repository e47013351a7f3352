"""Models of chunks: what each must be able to learn, and that its steps are those of its equations."""

from __future__ import annotations

from collections.abc import Callable

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from mart.trainer.models.layers.act import ActionChunkingTransformer, TransformerSize
from mart.trainer.models.layers.attention import Attention
from mart.trainer.models.layers.chunks import HISTORY, ChunkModel
from mart.trainer.models.layers.diffusion import Diffusion, noise_levels
from mart.trainer.models.layers.flow import Flow
from mart.trainer.models.layers.stack import full
from mart.trainer.models.layers.two_step import TwoStep
from mart.trainer.models.rng import Draws, UpdateRng

CHUNK, SIZE, SEEN, BATCH = 2, 1, 1, 64
CPU = torch.device("cpu")


def _generators(models: int) -> list[torch.Generator]:
    return [torch.Generator().manual_seed(m) for m in range(models)]


def _flow(models: int) -> ChunkModel:
    obs = full(models, HISTORY * SEEN)
    return Flow(obs, _generators(models), size=SIZE, chunk=CHUNK, hidden=(64, 64), steps=10)


def _diffusion(models: int) -> ChunkModel:
    obs = full(models, HISTORY * SEEN)
    return Diffusion(obs, _generators(models), size=SIZE, chunk=CHUNK, hidden=(64, 64), steps=10)


def _two_step(models: int) -> ChunkModel:
    obs = full(models, HISTORY * SEEN)
    return TwoStep(obs, _generators(models), size=SIZE, chunk=CHUNK, hidden=(64, 64))


def _transformer(models: int) -> ChunkModel:
    sizes = TransformerSize(width=16, heads=2, layers=1, latent=2, kl_weight=0.01)
    obs = full(models, HISTORY * SEEN)
    return ActionChunkingTransformer(obs, _generators(models), size=SIZE, chunk=CHUNK, sizes=sizes)


MAKERS = [_flow, _diffusion, _two_step, _transformer]


def _draws(update: int, batch: int = BATCH) -> Draws:
    return Draws(UpdateRng([0], update, CPU), 1, batch)


def _learn(model: ChunkModel, demonstrated: Callable[[Tensor, Draws], Tensor], updates: int) -> None:
    optimizer = torch.optim.Adam(model.parameters(), 5e-3)
    for update in range(updates):
        draws = _draws(update)
        obs = draws.uniform()[..., None].expand(-1, -1, HISTORY * SEEN) * 2 - 1
        optimizer.zero_grad()
        model.loss(obs, demonstrated(obs, draws), draws).mean().backward()
        optimizer.step()


def _either_way(obs: Tensor, draws: Draws) -> Tensor:
    """Half of the people pass on the left, half on the right; nobody goes straight on."""
    side = torch.where(draws.uniform() < 0.5, -0.6, 0.6)
    return side[..., None].expand(*obs.shape[:-1], CHUNK * SIZE)


def _wave(obs: Tensor, draws: Draws) -> Tensor:
    del draws
    return torch.cat((torch.sin(3 * obs[..., :1]), obs[..., :1]), -1)


@pytest.mark.slow
@pytest.mark.parametrize("make", [_flow, _diffusion])
def test_two_ways_are_both_learned_where_their_mean_would_fail(make: Callable[[int], ChunkModel]) -> None:
    model = make(1)
    _learn(model, _either_way, 600)
    with torch.no_grad():
        done = model.sample(torch.zeros(1, BATCH, HISTORY * SEEN), _draws(10_000))[0]
    sides = done.mean(-1)
    assert (done.abs() > 0.35).float().mean() > 0.9
    assert 0.25 < (sides > 0).float().mean() < 0.75
    assert (done[:, 0] * done[:, 1] > 0).float().mean() > 0.9  # a chunk keeps to its side


@pytest.mark.slow
@pytest.mark.parametrize("make", MAKERS)
def test_what_follows_from_the_observation_is_learned(make: Callable[[int], ChunkModel]) -> None:
    model = make(1)
    _learn(model, _wave, 400)
    obs = torch.linspace(-0.9, 0.9, BATCH)[None, :, None].expand(-1, -1, HISTORY * SEEN)
    with torch.no_grad():
        error = (model.sample(obs, _draws(10_000)) - _wave(obs, _draws(0))).abs()
    assert error.mean() < 0.12


@pytest.mark.slow
def test_the_transformer_tells_ways_apart_that_it_was_shown() -> None:
    model = _transformer(1)
    _learn(model, _either_way, 300)
    obs, draws = torch.zeros(1, BATCH, HISTORY * SEEN), _draws(10_000)
    shown = _either_way(obs, draws)
    with torch.no_grad():
        assert (model.reconstruct(obs, shown, draws) - shown).abs().mean() < 0.3


@pytest.mark.parametrize("make", MAKERS)
def test_models_never_meet(make: Callable[[int], ChunkModel]) -> None:
    """What one of two models loses and does depends on its own row of inputs alone."""
    model = make(2)
    obs, actions = torch.randn(2, 4, HISTORY * SEEN), torch.rand(2, 4, CHUNK * SIZE) * 2 - 1
    other = obs.clone()
    other[1] += 1
    draws = [Draws(UpdateRng([3, 4], 0, CPU), 1, 4) for _ in range(4)]
    assert torch.equal(model.loss(obs, actions, draws[0])[0], model.loss(other, actions, draws[1])[0])
    done, moved = model.sample(obs, draws[2]), model.sample(other, draws[3])
    assert torch.equal(done[0], moved[0])
    assert not torch.equal(done[1], moved[1])


def test_diffusion_with_the_exact_denoiser_draws_the_distribution() -> None:
    """Of N(m, s^2) the expected value behind noise is known: many steps must draw that Gaussian."""
    mean, deviation = 0.2, 0.15

    class Exact(Diffusion):
        def denoise(self, x: Tensor, sigma: Tensor, obs: Tensor) -> Tensor:
            del obs
            part = deviation**2 / (deviation**2 + sigma * sigma)
            return mean + part * (x - mean)

    model = Exact(full(1, HISTORY), _generators(1), size=1, chunk=1, hidden=(4,), steps=200)
    drawn = model.sample(torch.zeros(1, 4000, HISTORY), _draws(0, 4000))
    assert abs(drawn.mean() - mean) < 0.015
    assert abs(drawn.std() - deviation) < 0.015


@given(st.integers(1, 200))
def test_noise_falls_step_by_step(steps: int) -> None:
    levels = noise_levels(steps)
    assert len(levels) == steps
    assert levels == sorted(levels, reverse=True)
    assert levels[0] == pytest.approx(50)
    assert levels[-1] > 0


def test_two_steps_are_those_of_the_equations() -> None:
    model = _two_step(1)
    assert isinstance(model, TwoStep)
    obs = torch.randn(1, 5, HISTORY * SEEN)
    first = model(torch.zeros(1, 5, CHUNK * SIZE), torch.zeros(1, 5, 1), obs)
    second = model(first, torch.full((1, 5, 1), 0.9), obs)
    assert torch.equal(model.sample(obs, _draws(0)), second)


@settings(max_examples=20)
@given(st.integers(1, 3), st.integers(1, 4), st.integers(1, 5))
def test_attention_is_torchs(batch: int, queries: int, keys: int) -> None:
    width, heads = 8, 2
    ours = Attention(1, width, heads, _generators(1))
    theirs = torch.nn.MultiheadAttention(width, heads, batch_first=True)
    with torch.no_grad():
        theirs.in_proj_weight.copy_(
            torch.cat((ours.query.weight[0].T, ours.key[0].T, ours.value.weight[0].T))
        )
        nothing = torch.zeros(width)
        theirs.in_proj_bias.copy_(torch.cat((ours.query.bias[0, 0], nothing, ours.value.bias[0, 0])))
        theirs.out_proj.weight.copy_(ours.out.weight[0].T)
        theirs.out_proj.bias.copy_(ours.out.bias[0, 0])
    x, of = torch.randn(batch, queries, width), torch.randn(batch, keys, width)
    torch.testing.assert_close(ours(x[None], of[None])[0], theirs(x, of, of)[0], atol=1e-5, rtol=1e-4)
