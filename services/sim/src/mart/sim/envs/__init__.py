"""Every task as an environment of Gymnasium (joint) and of PettingZoo (one agent for each arm), in this process.

Importing this registers every task with Gymnasium: `gymnasium.make("mart/TwoArmMultiCubeLifting-v0")`. Needs the extra
`mart-sim[envs]`. Guide: docs/how-to-use-the-environments.md.
"""

from __future__ import annotations

from mart.protocol.errors import Unavailable
from mart.protocol.tasks import task_names

try:
    import gymnasium

    from mart.sim.envs.joint import JointEnv
    from mart.sim.envs.parallel import ArmsEnv
except ImportError as error:
    raise Unavailable(
        f"The environments need what this installation lacks ({error}): pip install 'mart-sim[envs]'."
    ) from error

__all__ = ["ArmsEnv", "JointEnv", "gymnasium_id"]


def gymnasium_id(task: str) -> str:
    """`two_arm_multi_cube_lifting` is `mart/TwoArmMultiCubeLifting-v0`."""
    return f"mart/{''.join(word.capitalize() for word in task.split('_'))}-v0"


for _task in task_names():
    gymnasium.register(gymnasium_id(_task), f"{JointEnv.__module__}:JointEnv", kwargs={"task": _task})
