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
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from mart.protocol.batch_state import ACTION_SIZE
from mart.trainer.data.layout import Layout
from mart.trainer.data.windows import Batch
from mart.trainer.grid import Model
from mart.trainer.nets.actors import Actor, Memory, Memoryless, Recurrent
from mart.trainer.nets.heads import MeanHead, MixtureHead
from mart.trainer.nets.residual import Residual
from mart.trainer.nets.stack import Generators
from mart.trainer.nets.vae import Planner
from mart.trainer.nets.views import View
from mart.trainer.noise import Noise
from mart.trainer.presets import Hyperparameters


@dataclass(frozen=True)
class Losses:
    """Of an update. `of_models`: by name, each [M], to be minimised; `seen`: by name, numbers to look at."""

    of_models: dict[str, Tensor]
    seen: dict[str, Tensor]

    @property
    def total(self) -> Tensor:
        """Models never meet, so the gradient of the sum is that of each."""
        return torch.stack([loss.sum() for loss in self.of_models.values()]).sum()


class Hierarchy(nn.Module):
    """Planner, actor and residual, any but the actor possibly absent."""

    def __init__(
        self,
        model: Model,
        layout: Layout,
        sizes: Hyperparameters,
        seeds: Sequence[int],
        dtype: torch.dtype = torch.float32,
    ) -> None:
        super().__init__()
        self.model, self.sizes, self.seeds = model, sizes, len(seeds)
        self.view = View(layout, model.actor)
        self.plan_view = None if model.planner == "none" else View(layout, model.planner)
        self.residual_view = None if model.residual == "none" else View(layout, model.residual)
        self.planner = self._planner(layout, seeds)
        self.actor = self._actor(seeds, dtype)
        self.residual = self._residual(seeds)

    def base_losses(self, batch: Batch, noise: Noise) -> Losses:
        """Of planner and actor."""
        losses, looks = {}, {}
        goal = None
        if self.planner is not None and self.plan_view is not None:
            view = self.plan_view
            seen, goal = view.of(batch.seen[:, 0]), view.of(batch.goal)
            plan = self.planner.loss(seen, goal, noise.normal(view.units, seen.shape[1], self.planner.latent))
            each = plan.reconstruction + self.sizes.kl_weight * plan.divergence
            weights = None if batch.weights is None else _mean_weights(view, batch.weights[:, 0])
            losses["planner"] = _mean(each, weights)
            looks = {"reconstruction": plan.reconstruction.mean(1), "divergence": plan.divergence.mean(1)}
            goal = self._routed(goal)
        each = self.actor.loss(self._inputs(batch.seen, goal), self.view.split(batch.actions))
        weights = None if batch.weights is None else _mean_weights(self.view, batch.weights)
        losses["actor"] = _mean(each, weights)
        return Losses(losses, {name: value.detach() for name, value in looks.items()})

    def residual_losses(self, batch: Batch, noise: Noise) -> Losses:
        """Of the residual; base and planner are frozen, and the base acts on retold subgoals."""
        assert self.residual is not None
        assert self.residual_view is not None
        with torch.no_grad():
            base = self._sequence(batch, noise)
        view = self.residual_view
        actions = view.split(base)
        delta = self.residual(view.of(batch.seen), actions)
        each = ((actions + delta - view.split(batch.actions)) ** 2).mean(-1)
        weights = None if batch.weights is None else _mean_weights(view, batch.weights)
        length = delta.detach().unflatten(-1, (-1, ACTION_SIZE)).norm(dim=-1)
        looks = {
            "base": ((base - batch.actions) ** 2).flatten(1).mean(1),
            "correction": length.flatten(1).mean(1),
            "correction_at_bound": (length > 0.95 * self.residual.epsilon).float().flatten(1).mean(1),
        }
        return Losses({"residual": _mean(each, weights)}, looks)

    def start(self, batch: int) -> Memory:
        return self.actor.body.start(batch)

    def plan(self, seen: Tensor, noise: Noise) -> Tensor | None:
        """A subgoal as the actor takes it. seen: [S, B, D] → [M, B, G]; None without a planner."""
        if self.planner is None or self.plan_view is None:
            return None
        view, batch = self.plan_view, seen.shape[1]
        choice = noise.uniform(view.units, batch)
        drawn = noise.normal(view.units, batch, self.planner.latent)
        return self._routed(self.planner.sample(view.of(seen), choice, drawn))

    def act(self, seen: Tensor, goal: Tensor | None, memory: Memory, noise: Noise) -> tuple[Tensor, Memory]:
        """One tick. seen: [S, B, D] → [S, B, arms, 7], and what the actor remembers."""
        inputs = self._inputs(seen[:, None], goal)[:, 0]
        actions, memory = self.actor.step(inputs, memory, *self._draws(seen.shape[1], noise))
        merged = self.view.merge(actions)
        if self.residual is not None and self.residual_view is not None:
            view = self.residual_view
            merged = merged + view.merge(self.residual(view.of(seen), view.split(merged)))
        return merged.clamp(-1, 1), memory

    def _sequence(self, batch: Batch, noise: Noise) -> Tensor:
        """What the base does over a window, on the way that was demonstrated: [S, T, B, arms, 7]."""
        ticks, size = batch.seen.shape[1:3]
        inputs = self._inputs(batch.seen, self._retold(batch, noise))
        return self.view.merge(self.actor.sequence(inputs, *self._draws(ticks * size, noise)))

    def _retold(self, batch: Batch, noise: Noise) -> Tensor | None:
        """The demonstrated subgoal in the planner's words, as the actor takes it: [M, B, G]."""
        if self.planner is None or self.plan_view is None:
            return None
        view, seen = self.plan_view, batch.seen[:, 0]
        drawn = noise.normal(view.units, seen.shape[1], self.planner.latent)
        return self._routed(self.planner.retell(view.of(seen), view.of(batch.goal), drawn))

    def _draws(self, batch: int, noise: Noise) -> tuple[Tensor, Tensor]:
        return noise.uniform(self.view.units, batch), noise.normal(
            self.view.units, batch, self.view.action_size
        )

    def _inputs(self, seen: Tensor, goal: Tensor | None) -> Tensor:
        """What the actor is given: [S, T, B, D] and [M, B, G] → [M, T, B, I]."""
        own = self.view.of(seen)
        return own if goal is None else torch.cat((own, goal[:, None].expand(-1, own.shape[1], -1, -1)), -1)

    def _routed(self, goal: Tensor) -> Tensor:
        """From the planner's view to the actor's: [planners, B, width] → [actors, B, G].

        To one actor from many planners they all go, side by side: where arms see the same thing, what is planned for
        it may differ, and the actor is given every opinion. From one planner each of many actors gets its arm's part.
        """
        assert self.plan_view is not None
        if self.plan_view.units == self.view.units:
            return goal
        if self.plan_view.units == 1:
            return self.view.of(goal)
        return goal.unflatten(0, (-1, self.plan_view.units)).movedim(1, -2).flatten(-2)

    def _goal_mask(self) -> Tensor:
        """bool[units, G]: which columns of the actor's subgoal are real."""
        if self.plan_view is None:
            return torch.zeros(self.view.units, 0, dtype=torch.bool)
        return self.plan_view.real.flatten()[None] if self.view.units == 1 else self.view.real

    def _planner(self, layout: Layout, seeds: Sequence[int]) -> Planner | None:
        if self.plan_view is None:
            return None
        sizes, view = self.sizes, self.plan_view
        return Planner(
            view.stacked(len(seeds)),
            _equal_by_name(layout, view).repeat(len(seeds), 1),
            generators(seeds, view.units, "planner"),
            hidden=sizes.vae_hidden,
            latent=sizes.vae_latent,
            modes=sizes.vae_prior_modes,
        )

    def _actor(self, seeds: Sequence[int], dtype: torch.dtype) -> Actor:
        sizes, view = self.sizes, self.view
        inputs = torch.cat((view.real, self._goal_mask()), 1).repeat(len(seeds), 1)
        own = generators(seeds, view.units, "actor")
        body: Recurrent | Memoryless
        if self.model.network == "rnn":
            body = Recurrent(inputs, own, width=sizes.rnn_hidden, layers=sizes.rnn_layers, dtype=dtype)
        else:
            body = Memoryless(inputs, own, hidden=sizes.mlp_hidden)
        head = (
            MeanHead(body.features, view.action_size, own)
            if self.model.head == "l2"
            else MixtureHead(body.features, view.action_size, sizes.gmm_modes, own)
        )
        return Actor(body, head)

    def _residual(self, seeds: Sequence[int]) -> Residual | None:
        if self.residual_view is None:
            return None
        sizes, view = self.sizes, self.residual_view
        return Residual(
            view.stacked(len(seeds)),
            generators(seeds, view.units, "residual"),
            arms=view.arms,
            hidden=sizes.residual_hidden,
            epsilon=sizes.residual_epsilon,
        )


def generators(seeds: Sequence[int], units: int, part: str) -> Generators:
    """One for each model, of its seed, its unit and the part of the hierarchy alone."""
    label = int.from_bytes(part.encode(), "little")
    states = [
        np.random.SeedSequence([seed, unit, label]).generate_state(1)[0]
        for seed in seeds
        for unit in range(units)
    ]
    return [torch.Generator().manual_seed(int(state)) for state in states]


def _equal_by_name(layout: Layout, view: View) -> Tensor:
    """float32[units, width]: weights of columns so that each named observation counts the same; sum 1."""
    groups = torch.from_numpy(layout.groups())
    index = view.index
    group = torch.where(index >= 0, groups[index], len(layout.seen))
    counts = torch.nn.functional.one_hot(group, len(layout.seen) + 1).sum(1)
    names = (counts[:, :-1] > 0).sum(1, keepdim=True)
    return view.real / (torch.gather(counts, 1, group) * names)


def _mean_weights(view: View, weights: Tensor) -> Tensor:
    """Of each model, over the arms that it drives: [S, ..., arms] → [M, ...]."""
    return view.per_unit(weights).mean(-1)


def _mean(each: Tensor, weights: Tensor | None) -> Tensor:
    """[M, ...] → [M]."""
    return (each if weights is None else each * weights).flatten(1).mean(1)
