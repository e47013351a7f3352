"""Run one episode in this process, with a script at every arm: to try a task out."""

from __future__ import annotations

import numpy as np

from mart.sim.experts.expert import Expert
from mart.sim.experts.people import get_skill
from mart.sim.world import TaskProgress, World


def run_experts(world: World, seed: int, skill: str = "expert", until_s: float | None = None) -> TaskProgress:
    """Play one episode until success, failure, `until_s` (simulated) or the time limit; return the progress then."""
    world.reset(seed)
    randoms = np.random.default_rng(seed).spawn(len(world.arms))
    experts = {
        arm: Expert(world.task, arm, get_skill(skill), random)
        for arm, random in zip(world.arms, randoms, strict=True)
    }
    targets = {arm: world.tool_pose_in_base(arm) for arm in world.arms}
    limit_s = world.task.time_limit_s if until_s is None else until_s
    progress = world.progress()
    while not (progress.success or progress.failed or world.sim_time_s >= limit_s):
        actions = []
        for arm, expert in experts.items():
            intent = expert.act(world.observations_for(arm), world.sim_time_s)
            if intent.engaged:
                targets[arm] = intent.pose_tool_in_base
            actions.append(world.action_for(arm, targets[arm], intent.gripper))
        world.step(actions)
        progress = world.progress()
    return progress
