"""The networks of one point of the grid, for many seeds at once: who plans, who acts and who corrects.

    subgoal  g ~ planner(o)                       every `window` ticks
    action   a = actor(o, g)                      every tick
    result   a + residual(o, a)                   where there is a residual

Planner and actor are trained apart, the actor on subgoals that were really reached (robomimic's mode "separate"). The
residual is trained after both, on what the base does with the demonstrated subgoal in its planner's words, drawn from
the posterior. Given the true one, there is nothing left to correct; given one of the prior's, which may be another
intention, it would learn to act against what is intended (decision 0024).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import torch
from torch import Tensor, nn

from mart.protocol.batch_state import ACTION_SIZE
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.windows import WindowBatch
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.models.arm_partition import ArmPartition
from mart.trainer.models.arm_residual import ArmResidual
from mart.trainer.models.hyperparameters import Hyperparameters
from mart.trainer.models.layers.actors import Actor, Memory, Memoryless, Recurrent
from mart.trainer.models.layers.heads import MeanHead, MixtureHead
from mart.trainer.models.layers.vae import Planner
from mart.trainer.models.losses import Losses
from mart.trainer.models.one_arm import OneArmWindows, for_one_arm, seen_by_arm
from mart.trainer.models.rng import Rng, weight_generators


class HierarchicalBC(nn.Module):
    """Planner, actor and residual, any but the actor possibly absent."""

    def __init__(
        self,
        model: ModelSpec,
        layout: ObservationLayout,
        sizes: Hyperparameters,
        seeds: Sequence[int],
        dtype: torch.dtype = torch.float32,
    ) -> None:
        super().__init__()
        self.model, self.sizes, self.seeds = model, sizes, len(seeds)
        self.partition = ArmPartition(layout, model.actor)
        self.planner_partition = None if model.planner == "none" else ArmPartition(layout, model.planner)
        self._seen: Tensor
        self.register_buffer("_seen", seen_by_arm(layout), persistent=False)
        self.planner = self._planner(layout, seeds)
        self.actor = self._actor(seeds, dtype)
        self.residual = ArmResidual.of(layout, model.residual, sizes, seeds)

    def base_losses(self, batch: WindowBatch, rng: Rng) -> Losses:
        """Return the losses of planner and actor."""
        losses, looks = {}, {}
        batch, windows = self._shown(batch, rng)
        goal = None
        if self.planner is not None and self.planner_partition is not None:
            partition = self.planner_partition
            obs, goal = partition.of(batch.obs[:, 0]), partition.of(batch.goal)
            noise = rng.normal(partition.units, obs.shape[1], self.planner.latent)
            told = None if windows is None else partition.of(windows.told)
            plan = self.planner.loss(obs, goal, noise, told)
            each = plan.reconstruction + self.sizes.kl_weight * plan.divergence
            if windows is not None:
                each = each * _mean_weights(partition, windows.counted)
            weights = None if batch.weights is None else _mean_weights(partition, batch.weights[:, 0])
            losses["planner"] = _mean(each, weights)
            looks = {"reconstruction": plan.reconstruction.mean(1), "divergence": plan.divergence.mean(1)}
            goal = self._routed(goal)
        actions = self.partition.split(batch.actions)
        counted = None if windows is None else self._counted(windows.counted).expand_as(actions)
        each = self.actor.loss(self._inputs(batch.obs, goal), actions, counted)
        weights = None if batch.weights is None else _mean_weights(self.partition, batch.weights)
        losses["actor"] = _mean(each, weights)
        return Losses(losses, {name: value.detach() for name, value in looks.items()})

    def residual_losses(self, batch: WindowBatch, rng: Rng) -> Losses:
        """Return the losses of the residual; the base is frozen and acts on reconstructed subgoals."""
        assert self.residual is not None
        batch = _noisy(batch, self.sizes.observation_noise, rng)
        with torch.no_grad():
            base = self._sequence(batch, rng)
        return self.residual.losses(batch.obs, base, batch.actions, batch.weights)

    def start(self, batch: int) -> Memory:
        """Return what the actor remembers before the first tick of a window."""
        return self.actor.body.start(batch)

    def plan(self, obs: Tensor, rng: Rng) -> Tensor | None:
        """Draw a subgoal, as the actor takes it. obs: [S, B, D] → [M, B, G]; None without a planner."""
        if self.planner is None or self.planner_partition is None:
            return None
        partition, batch = self.planner_partition, obs.shape[1]
        choice = rng.uniform(partition.units, batch)
        drawn = rng.normal(partition.units, batch, self.planner.latent)
        return self._routed(self.planner.sample(partition.of(obs), choice, drawn))

    def act(self, obs: Tensor, goal: Tensor | None, memory: Memory, rng: Rng) -> tuple[Tensor, Memory]:
        """Act for one tick. obs: [S, B, D] → [S, B, arms, 7] in [-1, 1], and what the actor remembers."""
        inputs = self._inputs(obs[:, None], goal)[:, 0]
        actions, memory = self.actor.step(inputs, memory, *self._draws(obs.shape[1], rng))
        merged = self.partition.merge(actions)
        if self.residual is not None:
            merged = self.residual.corrected(obs, merged)
        return merged.clamp(-1, 1), memory

    def _sequence(self, batch: WindowBatch, rng: Rng) -> Tensor:
        """Return what the base does over a window, on the way that was demonstrated: [S, T, B, arms, 7]."""
        ticks, size = batch.obs.shape[1:3]
        inputs = self._inputs(batch.obs, self._subgoal(batch, rng))
        return self.partition.merge(self.actor.sequence(inputs, *self._draws(ticks * size, rng)))

    def _subgoal(self, batch: WindowBatch, rng: Rng) -> Tensor | None:
        """Return what a residual's base acts on while it learns, as the actor takes it: [M, B, G].

        That is the demonstrated subgoal, encoded and decoded by the planner, unless the sizes say another one.
        """
        if self.planner is None or self.planner_partition is None:
            return None
        partition, obs = self.planner_partition, batch.obs[:, 0]
        if self.sizes.residual_subgoal == "prior":
            return self.plan(obs, rng)
        if self.sizes.residual_subgoal == "true":
            return self._routed(partition.of(batch.goal))
        drawn = rng.normal(partition.units, obs.shape[1], self.planner.latent)
        return self._routed(self.planner.reconstruct(partition.of(obs), partition.of(batch.goal), drawn))

    def _shown(self, batch: WindowBatch, rng: Rng) -> tuple[WindowBatch, OneArmWindows | None]:
        """Return the windows as they are learned from: with noise, and some of them for one arm alone."""
        sizes = self.sizes
        batch = _noisy(batch, sizes.observation_noise, rng)
        if sizes.one_arm_share == 0:
            return batch, None
        windows = for_one_arm(
            batch.obs, batch.goal, self._seen, rng, share=sizes.one_arm_share, hiding=sizes.one_arm_hides
        )
        return replace(batch, obs=windows.obs, goal=windows.goal), windows

    def _counted(self, counted: Tensor) -> Tensor:
        """Return how much each number of an action counts: [S, B, arms] → [M, 1, B, A]."""
        return self.partition.per_unit(counted).repeat_interleave(ACTION_SIZE, -1)[:, None]

    def _draws(self, batch: int, rng: Rng) -> tuple[Tensor, Tensor]:
        return rng.uniform(self.partition.units, batch), rng.normal(
            self.partition.units, batch, self.partition.action_size
        )

    def _inputs(self, obs: Tensor, goal: Tensor | None) -> Tensor:
        """Return what the actor is given: [S, T, B, D] and [M, B, G] → [M, T, B, I]."""
        own = self.partition.of(obs)
        return own if goal is None else torch.cat((own, goal[:, None].expand(-1, own.shape[1], -1, -1)), -1)

    def _routed(self, goal: Tensor) -> Tensor:
        """Bring subgoals from the planner's units to the actor's: [planners, B, width] → [actors, B, G].

        To one actor from many planners they all go, side by side: where arms see the same thing, what is planned for
        it may differ, and the actor is given every opinion. From one planner each of many actors gets its arm's part.
        """
        assert self.planner_partition is not None
        if self.planner_partition.units == self.partition.units:
            return goal
        if self.planner_partition.units == 1:
            return self.partition.of(goal)
        return goal.unflatten(0, (-1, self.planner_partition.units)).movedim(1, -2).flatten(-2)

    def _goal_mask(self) -> Tensor:
        """Return bool[units, G]: which columns of the actor's subgoal are real."""
        if self.planner_partition is None:
            return torch.zeros(self.partition.units, 0, dtype=torch.bool)
        return (
            self.planner_partition.real.flatten()[None] if self.partition.units == 1 else self.partition.real
        )

    def _planner(self, layout: ObservationLayout, seeds: Sequence[int]) -> Planner | None:
        if self.planner_partition is None:
            return None
        sizes, partition = self.sizes, self.planner_partition
        return Planner(
            partition.stacked(len(seeds)),
            _equal_by_name(layout, partition).repeat(len(seeds), 1),
            weight_generators(seeds, partition.units, "planner"),
            hidden=sizes.vae_hidden,
            latent=sizes.vae_latent,
            modes=sizes.vae_prior_modes,
        )

    def _actor(self, seeds: Sequence[int], dtype: torch.dtype) -> Actor:
        sizes, partition = self.sizes, self.partition
        inputs = torch.cat((partition.real, self._goal_mask()), 1).repeat(len(seeds), 1)
        own = weight_generators(seeds, partition.units, "actor")
        body: Recurrent | Memoryless
        if self.model.network == "rnn":
            body = Recurrent(inputs, own, width=sizes.rnn_hidden, layers=sizes.rnn_layers, dtype=dtype)
        else:
            body = Memoryless(inputs, own, hidden=sizes.mlp_hidden)
        head = (
            MeanHead(body.features, partition.action_size, own)
            if self.model.head == "l2"
            else MixtureHead(body.features, partition.action_size, sizes.gmm_modes, own)
        )
        return Actor(body, head)


def _equal_by_name(layout: ObservationLayout, partition: ArmPartition) -> Tensor:
    """Return float32[units, width]: weights of columns so that each named observation counts the same; sum 1."""
    groups = torch.from_numpy(layout.groups())
    index = partition.index
    group = torch.where(index >= 0, groups[index], len(layout.fields))
    counts = torch.nn.functional.one_hot(group, len(layout.fields) + 1).sum(1)
    names = (counts[:, :-1] > 0).sum(1, keepdim=True)
    return partition.real / (torch.gather(counts, 1, group) * names)


def _mean_weights(partition: ArmPartition, weights: Tensor) -> Tensor:
    """Average the weights of each model over the arms that it drives: [S, ..., arms] → [M, ...]."""
    return partition.per_unit(weights).mean(-1)


def _mean(each: Tensor, weights: Tensor | None) -> Tensor:
    """Average over all but the models, weighted: [M, ...] → [M]."""
    return (each if weights is None else each * weights).flatten(1).mean(1)


def _noisy(batch: WindowBatch, deviations: float, rng: Rng) -> WindowBatch:
    """Return windows whose observations, but not the goal, are beside what was seen: by one amount in all ticks."""
    if deviations == 0:
        return batch
    noise = rng.normal(1, *batch.goal.shape[1:])
    return replace(batch, obs=batch.obs + deviations * noise[:, None])
