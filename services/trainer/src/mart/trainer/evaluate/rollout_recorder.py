"""Keep episodes of an evaluation to look at: stepped once more with the same actions, they go the same way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mart.protocol import clock
from mart.protocol.tasks import Task
from mart.protocol.vocabulary import EpisodeOutcome
from mart.rollouts.client import BatchState, RolloutClient
from mart.trainer.evaluate.evaluation import RolloutOutcome
from mart.trainer.evaluate.rollout_episode import RolloutEpisode, write
from mart.trainer.evaluate.rollouts import RolloutResult


@dataclass(frozen=True)
class RolloutRecorder:
    """Record episodes of one policy. policy: its name, for people."""

    client: RolloutClient
    task: Task
    control_hz: float
    policy: str

    def keep(self, rollouts: Mapping[Path, RolloutResult]) -> None:
        """Write each rollout as an episode file at its path."""
        if not rollouts:
            return
        model = self.client.model(self.task.name, self.control_hz, len(self.task.arms), self.task.arm_kinds)
        states_by_tick = self._step_again(list(rollouts.values()))
        for world, (path, rollout) in enumerate(rollouts.items()):
            write(path, self._episode(rollout, states_by_tick, world), model, clock.wall_ns())

    def _step_again(self, rollouts: Sequence[RolloutResult]) -> list[BatchState]:
        """Return how the worlds stood after each tick; one whose rollout has ended stands still."""
        seeds = [rollout.result.seed for rollout in rollouts]
        ticks = np.array([len(rollout.actions) for rollout in rollouts])
        arms = len(self.task.arms)
        states_by_tick = [
            self.client.reset(
                self.task.name,
                seeds,
                self.control_hz,
                arms,
                arm_kinds=self.task.arm_kinds,
                integration_states=True,
            )
        ]
        for tick in range(int(ticks.max())):
            actions = [rollout.actions[min(tick, len(rollout.actions) - 1)] for rollout in rollouts]
            states_by_tick.append(self.client.step(np.array(actions), tick < ticks))
        return states_by_tick

    def _episode(
        self, rollout: RolloutResult, states_by_tick: Sequence[BatchState], world: int
    ) -> RolloutEpisode:
        own, result = states_by_tick[: len(rollout.actions) + 1], rollout.result
        states = (look.integration_states for look in own)
        return RolloutEpisode(
            task=self.task,
            control_hz=self.control_hz,
            policy=self.policy,
            seed=result.seed,
            outcome=EpisodeOutcome.SUCCESS if result.succeeded else EpisodeOutcome.FAILURE,
            reason=own[-1].reasons[world] or ("time is up" if result.outcome is RolloutOutcome.TIME else ""),
            integration_states=[
                state[world].astype("<f8").tobytes() for state in states if state is not None
            ],
            observations={
                name: np.array([look.observations[name][world] for look in own])
                for name in own[0].observations
            },
            actions=rollout.actions,
            subtasks=np.array([look.subtasks[world] for look in own]),
        )
