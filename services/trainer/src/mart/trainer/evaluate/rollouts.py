"""Roll policies out in worlds, in lockstep: everything that acts in one tick is one request."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mart.protocol.batch_state import ACTION_SIZE, BatchState
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Model
from mart.protocol.tasks import Task, get_task
from mart.rollouts.client import RolloutClient
from mart.trainer.evaluate.evaluation import EpisodeResult, RolloutOutcome
from mart.trainer.models.policies.policy import pictures_of

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

Array = NDArray[np.float64]
# Of a policy's worlds, by name: of the states float64[worlds, size], where the flags bool[worlds] want them.
DrawPictures = Callable[["Policy", Array, NDArray[np.bool_]], Mapping[str, NDArray[np.uint8]]]

# Fixed, so that an episode is the same however many policies are judged together: what a policy samples depends on the
# number of the world in its batch.
SEEDS_AT_ONCE = 50
_WORLDS_AT_ONCE = 250


@dataclass(frozen=True)
class RolloutResult:
    """One episode of a policy and what it did. actions: float64[ticks, arms, 7]."""

    result: EpisodeResult
    actions: Array


def roll_out(
    policies: Sequence[Policy],
    client: RolloutClient,
    seeds: Sequence[int],
    policy_seed: int,
    time_limit_s: float | None = None,
    *,
    on_ticks: Callable[[int], None] = lambda _: None,
) -> list[list[RolloutResult]]:
    """Let every policy act for one episode in every world; return the results by policy, in the order of `seeds`.

    All policies are of one task and rate and drive all of its arms. An episode ends with success, with an irrecoverable
    failure, or after `time_limit_s`, the length of the task's trials unless told.
    on_ticks: told how many ticks more are done with: each of `batch_count` batches has as many as the limit allows.
    Raises InvalidInput where the policies do not fit together, or without seeds.
    """
    if not len(seeds):
        raise InvalidInput("No seeds were given; give one for each world.")
    task = common_task(policies)
    together = _policies_at_once(len(seeds))
    groups = [policies[first : first + together] for first in range(0, len(policies), together)]
    limit_s = task.trial_limit_s if time_limit_s is None else time_limit_s
    results: list[list[RolloutResult]] = []
    for group in groups:
        found: list[list[RolloutResult]] = [[] for _ in group]
        for first in range(0, len(seeds), SEEDS_AT_ONCE):
            batch = _PolicyBatch(task, group, seeds[first : first + SEEDS_AT_ONCE])
            batch.roll_out(client, policy_seed + first, limit_s, on_ticks)
            for of_policy, more in zip(found, batch.results(), strict=True):
                of_policy.extend(more)
        results += found
    return results


def batch_count(policies: int, seeds: int) -> int:
    """Return in how many batches so many policies act in so many worlds."""
    return math.ceil(policies / _policies_at_once(seeds)) * math.ceil(seeds / SEEDS_AT_ONCE)


def _policies_at_once(seeds: int) -> int:
    return _WORLDS_AT_ONCE // min(seeds, SEEDS_AT_ONCE)


class _PolicyBatch:
    """Worlds of several policies side by side: those of policy k are `slices[k]`."""

    def __init__(self, task: Task, policies: Sequence[Policy], seeds: Sequence[int]) -> None:
        number = len(policies) * len(seeds)
        self._task = task
        self._policies = policies
        self._seeds = seeds
        self._slices = [slice(k * len(seeds), (k + 1) * len(seeds)) for k in range(len(policies))]
        self._done = np.zeros((number, len(task.subtasks)), bool)
        self._success = np.zeros(number, bool)
        self._failed = np.zeros(number, bool)
        self._ticks = np.zeros(number, int)
        self._actions: list[Array] = []

    def roll_out(
        self, client: RolloutClient, policy_seed: int, limit_s: float, on_ticks: Callable[[int], None]
    ) -> None:
        for policy in self._policies:
            policy.begin(len(self._seeds), policy_seed)
        if any(map(pictures_of, self._policies)):
            from mart.trainer.evaluate.rollout_pictures import RolloutPictures

            with RolloutPictures(self._model(client), self._policies) as shown:
                self._play(client, limit_s, on_ticks, shown.draw)
        else:
            self._play(client, limit_s, on_ticks, None)

    def _model(self, client: RolloutClient) -> Model:
        task = self._task
        return client.model(task.name, self._policies[0].control_hz, len(task.arms), task.arm_kinds)

    def _play(
        self,
        client: RolloutClient,
        limit_s: float,
        on_ticks: Callable[[int], None],
        draw: DrawPictures | None,
    ) -> None:
        task, control_hz = self._task, self._policies[0].control_hz
        worlds = client.reset(
            task.name,
            list(self._seeds) * len(self._policies),
            control_hz,
            len(task.arms),
            arm_kinds=task.arm_kinds,
            integration_states=draw is not None,
        )
        self._look(worlds)
        most = round(limit_s * control_hz)
        for tick in range(most):
            running = ~self._ended
            if not running.any():
                on_ticks(most - tick)
                return
            self._actions.append(self._act(worlds, draw))
            self._ticks += running
            worlds = client.step(self._actions[-1], running)
            self._look(worlds)
            on_ticks(1)

    @property
    def _ended(self) -> NDArray[np.bool_]:
        return self._success | self._failed

    def _act(self, worlds: BatchState, draw: DrawPictures | None) -> Array:
        """Return what is done next, float64[worlds, arms, 7]; zeros where a policy has nothing left to play."""
        observations = worlds.observations
        actions = np.zeros((len(self._ticks), len(self._task.arms), ACTION_SIZE))
        for policy, own in zip(self._policies, self._slices, strict=True):
            if not self._ended[own].all():
                seen: dict[str, NDArray[Any]] = {name: observations[name][own] for name in policy.needs}
                states = worlds.integration_states
                if draw is not None and states is not None:
                    seen |= draw(policy, states[own], ~self._ended[own])
                actions[own] = policy.act(seen)
        return actions

    def _look(self, worlds: BatchState) -> None:
        """Note how the worlds stand. Those that have ended stand still, so looking again changes nothing."""
        self._done |= worlds.subtasks
        self._success |= worlds.success
        self._failed |= worlds.failed & ~worlds.success

    def results(self) -> list[list[RolloutResult]]:
        actions = np.array(self._actions)
        return [
            [
                self._result(world, seed, actions)
                for world, seed in zip(range(own.start, own.stop), self._seeds, strict=True)
            ]
            for own in self._slices
        ]

    def _result(self, world: int, seed: int, actions: Array) -> RolloutResult:
        ticks = int(self._ticks[world])
        names = [subtask.name for subtask in self._task.subtasks]
        result = EpisodeResult(
            seed=seed,
            outcome=self._outcome(world),
            time_s=ticks / self._policies[0].control_hz,
            done=tuple(name for name, done in zip(names, self._done[world], strict=True) if done),
        )
        return RolloutResult(result, actions[:ticks, world])

    def _outcome(self, world: int) -> RolloutOutcome:
        if self._success[world]:
            return RolloutOutcome.SUCCESS
        return RolloutOutcome.FAILURE if self._failed[world] else RolloutOutcome.TIME


def common_task(policies: Sequence[Policy]) -> Task:
    """Return the task that all policies are for. Raises InvalidInput where they do not fit together."""
    kinds = {(policy.task, policy.control_hz) for policy in policies}
    if len(kinds) != 1:
        given = ", ".join(f"{task} at {control_hz:g} Hz" for task, control_hz in sorted(kinds))
        raise InvalidInput(
            f"Policies of {given or 'no task'} were given; judge those of one task and rate together."
        )
    if len({policy.arm_kinds for policy in policies}) > 1:
        given = "; ".join(sorted({", ".join(policy.arm_kinds) or "Pandas" for policy in policies}))
        raise InvalidInput(
            f"Policies for several kinds of arms (arm_kinds) were given: {given}; judge those of one together."
        )
    task = get_task(policies[0].task, len(policies[0].arms), policies[0].arm_kinds)
    needed = ", ".join(task.arm_names)
    for policy in policies:
        if policy.arms != task.arm_names:
            raise InvalidInput(
                f"A policy for {', '.join(policy.arms)} was given; {task.name} needs {needed}."
            )
    return task
