"""Register every task with Gymnasium."""

from __future__ import annotations

import gymnasium

from mart.protocol.tasks import task_names
from mart.sim.envs.joint import JointEnv


def gymnasium_id(task: str) -> str:
    """Return the id under which Gymnasium knows a task: `mart/TwoArmMultiCubeLifting-v0`."""
    return f"mart/{''.join(word.capitalize() for word in task.split('_'))}-v0"


def register_envs() -> tuple[str, ...]:
    """Register every task of the catalogue that is not registered yet; return all ids."""
    ids = {gymnasium_id(task): task for task in task_names()}
    for name in ids.keys() - gymnasium.registry.keys():
        gymnasium.register(name, f"{JointEnv.__module__}:{JointEnv.__name__}", kwargs={"task": ids[name]})
    return tuple(ids)
