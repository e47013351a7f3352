"""Eight arms, which no task has: two rooms' worth of world, stepped one after the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mart.protocol.pose import Pose
from mart.sim.settings import DEFAULT_TASK
from mart.sim.world import World


class PairOfWorlds:
    """Two worlds of four arms, told apart by numbering the second one's arms on. A World by what it does."""

    def __init__(self, control_hz: float) -> None:
        self._worlds = [World.build(DEFAULT_TASK, control_hz, 4) for _ in range(2)]
        first = self._worlds[0]
        self._home = {
            f"arm{index}": (first if index < 4 else self._worlds[1], f"arm{index % 4}") for index in range(8)
        }
        self.arms = tuple(self._home)
        self.task = first.task
        self.control_hz, self.control_period_s = first.control_hz, first.control_period_s
        self.model_sha256 = first.model_sha256
        self.model_bytes = first.model_bytes
        self.progress = first.progress

    @property
    def sim_time_s(self) -> float:
        return self._worlds[0].sim_time_s

    def reset(self, seed: int) -> None:
        for world in self._worlds:
            world.reset(seed)

    def tool_pose_in_base(self, arm: str) -> Pose:
        world, name = self._home[arm]
        return world.tool_pose_in_base(name)

    def gripper(self, arm: str) -> float:
        world, name = self._home[arm]
        return world.gripper(name)

    def action_for(self, arm: str, target_tool_in_base: Pose, gripper: float) -> NDArray[np.float64]:
        world, name = self._home[arm]
        return world.action_for(name, target_tool_in_base, gripper)

    def step(self, actions: ArrayLike) -> None:
        for world, share in zip(self._worlds, np.split(np.asarray(actions), 2), strict=True):
            world.step(share)

    def integration_state(self) -> bytes:
        return b"".join(world.integration_state() for world in self._worlds)

    def observations(self) -> dict[str, NDArray[np.float64]]:
        second = {_renumbered(name): value for name, value in self._worlds[1].observations().items()}
        return {**self._worlds[0].observations(), **second}


def _renumbered(name: str) -> str:
    thing, _, rest = name.partition("/")
    return f"{thing[:-1]}{int(thing[-1]) + 4}/{rest}"
