"""Models of chunks as policies of arms: who sees what, and what corrects them."""

from __future__ import annotations

import itertools

import pytest
import torch

from mart.trainer.data.windows import WindowBatch
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.chunk_policy_net import ChunkPolicyNet
from mart.trainer.models.layers.chunks import ChunkDenoiser
from mart.trainer.models.networks import Networks
from mart.trainer.models.rng import UpdateRng, WorldRng
from tests.trainer.models.test_hierarchical_bc import ARMS, CHUNKED, CPU, LAYOUT, SIZES, batch_of

NETWORKS = ["flow", "mip", "diffusion", "act"]
POINTS = [f"none/{a}/{r}/{n}" for (a, r), n in itertools.product(
    itertools.product(("joint", "per-arm"), ("none", "joint", "per-arm")), NETWORKS
)]  # fmt: skip


def nets_of(model: ModelSpec, epsilon: float = 0.05, *, normalise: bool = False) -> ChunkPolicyNet:
    sizes = SIZES.model_copy(update={"residual_epsilon": epsilon, "normalise_actions": normalise})
    nets = Networks(model, LAYOUT, sizes, [4]).model
    assert isinstance(nets, ChunkPolicyNet)
    if nets.residual is not None:
        generator = torch.Generator().manual_seed(0)
        torch.nn.init.normal_(nets.residual.net.last.weight, std=3.0, generator=generator)
    return nets


def act(nets: ChunkPolicyNet, obs: torch.Tensor) -> torch.Tensor:
    chunk = nets.chunk(torch.stack((obs, obs), 1), WorldRng(1, obs.shape[1], CPU))
    assert chunk.shape == (1, SIZES.chunk, obs.shape[1], ARMS, 7)
    return nets.corrected(obs, chunk[:, 0])


@pytest.mark.parametrize("point", POINTS)
def test_an_arm_of_a_decentral_model_does_not_see_what_it_should_not(point: str) -> None:
    model = ModelSpec.parse(point)
    nets = nets_of(model)
    foreign = sorted(set(range(LAYOUT.width)) - set(LAYOUT.columns_of("arm0").tolist()))
    obs = torch.randn(1, 3, LAYOUT.width)
    other = obs.clone()
    other[..., foreign] += 1.0
    same = torch.equal(act(nets, obs)[:, :, 0], act(nets, other)[:, :, 0])
    assert same == ("joint" not in {model.actor, model.residual})


@pytest.mark.parametrize("model", [m for m in CHUNKED if m.residual != "none"], ids=lambda m: m.point)
def test_epsilon_bounds_every_arms_correction_and_zero_is_the_base(model: ModelSpec) -> None:
    obs = torch.randn(1, 6, LAYOUT.width)
    base = act(nets_of(model.model_copy(update={"residual": "none"})), obs)
    assert torch.equal(act(nets_of(model, 0.0), obs), base)
    length = (act(nets_of(model, 0.05), obs) - base).norm(dim=-1)
    assert (length < 0.05 + 1e-6).all()
    assert (length > 0).all()


@pytest.mark.parametrize("network", NETWORKS)
def test_a_residual_learns_at_every_tick_that_is_done_and_no_other(network: str) -> None:
    """It sees each executed tick's observation beside the action that the chunk has for that tick."""
    model = ModelSpec.parse(f"none/per-arm/per-arm/{network}")
    nets, batch = nets_of(model), batch_of(model, 1)
    executed = SIZES.executed
    assert batch.obs.shape[1] == 1 + executed

    def loss(obs: torch.Tensor, actions: torch.Tensor) -> float:
        asked = WindowBatch(obs, batch.goal, actions, None)
        return float(nets.residual_losses(asked, UpdateRng([4], 0, CPU)).total.detach())

    plain = loss(batch.obs, batch.actions)
    for tick in range(executed):
        later = batch.obs.clone()
        later[:, 1 + tick] += 1
        assert loss(later, batch.actions) != plain
    beyond = batch.actions.clone()
    beyond[:, executed:] = 0
    assert network == "act" or loss(batch.obs, beyond) == plain  # act is told which way the chunk went


def test_actions_are_learned_normalised_and_done_as_they_are() -> None:
    """A model that answers the mean of what it learned, 0, does the mean of the data."""
    nets = nets_of(ModelSpec.parse("d-MIP"), normalise=True)
    assert nets.scale is not None
    nets.scale.mean.copy_(torch.linspace(-0.9, 0.9, ARMS * 7))
    nets.scale.deviation.fill_(0.1)
    assert isinstance(nets.chunks, ChunkDenoiser)
    nets.chunks.net.last.zero()
    done = nets.chunk(torch.randn(1, 2, 3, LAYOUT.width), WorldRng(0, 3, CPU))
    torch.testing.assert_close(done, nets.scale.mean.view(ARMS, 7).expand_as(done))
    batch = batch_of(nets.model, 1)
    batch.actions.copy_(nets.scale.mean.view(ARMS, 7).expand_as(batch.actions))
    noise = float(nets.base_losses(batch, UpdateRng([4], 0, CPU)).total.detach())
    assert noise == 0
