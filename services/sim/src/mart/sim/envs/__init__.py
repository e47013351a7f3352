"""Every task as an environment of Gymnasium (joint) and of PettingZoo (one agent for each arm), in this process.

Importing this registers every task with Gymnasium: `gymnasium.make("mart/TwoArmMultiCubeLifting-v0")`. Needs the extra
`mart-sim[envs]`. Guide: docs/how-to-use-the-environments.md.
"""

from __future__ import annotations

import gymnasium

from mart.protocol.tasks import task_names
from mart.sim.envs.joint import JointEnv
from mart.sim.envs.parallel import ArmsEnv

__all__ = ["ArmsEnv", "JointEnv", "gymnasium_id"]


def gymnasium_id(task: str) -> str:
    """`two_arm_multi_cube_lifting` is `mart/TwoArmMultiCubeLifting-v0`."""
    return f"mart/{''.join(word.capitalize() for word in task.split('_'))}-v0"


for _task in task_names():
    gymnasium.register(gymnasium_id(_task), f"{JointEnv.__module__}:JointEnv", kwargs={"task": _task})
