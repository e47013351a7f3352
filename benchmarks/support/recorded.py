"""Scripted experts at a task: states to time a step from, with the contacts that real work has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.sim.experts import Expert, get_skill
from mart.sim.world import World

_MOST_TICKS = 800


@dataclass(frozen=True)
class Recording:
    """An episode, T ticks up to success.

    states: before each tick, shape (T, size). actions: what was done, shape (T, arms, 7). controls: torques and finger
    targets at each tick's end, shape (T, nu).
    """

    states: NDArray[np.float64]
    actions: NDArray[np.float64]
    controls: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.actions)


def record(world: World, seed: int) -> Recording:
    """The same seed gives the same episode."""
    world.reset(seed)
    skill = get_skill("expert")
    experts = [
        Expert(world.task, arm, skill, np.random.default_rng((seed, index)))
        for index, arm in enumerate(world.arms)
    ]
    targets = [world.tool_pose_in_base(arm) for arm in world.arms]
    states: list[NDArray[np.float64]] = []
    actions, controls = [], []
    while not world.progress().success and len(states) < _MOST_TICKS:
        states.append(np.frombuffer(world.integration_state(), "<f8"))
        act = []
        for index, (arm, expert) in enumerate(zip(world.arms, experts, strict=True)):
            intent = expert.act(world.observations_for(arm), world.sim_time_s)
            if intent.engaged:
                targets[index] = intent.pose_tool_in_base
            act.append(world.action_for(arm, targets[index], intent.gripper))
        actions.append(np.clip(act, -1.0, 1.0))
        world.step(actions[-1])
        controls.append(world.data.ctrl.copy())
    return Recording(np.array(states), np.array(actions), np.array(controls))
