"""What every arm is told to do in one tick: its operator's target, or to stay where it was left."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.admission import Arrival
from mart.sim.world import World


class Targets:
    """A held arm has one fixed target, the pose in which it was let go: measured anew every tick, it would sink."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._held: dict[str, tuple[Pose, float]] = {}
        self._gripper = dict.fromkeys(world.arms, 0.0)

    def world_reset(self) -> None:
        """Arms are somewhere else now, their grippers as the reset left them."""
        self._held.clear()
        self._gripper = {arm: self._world.gripper(arm) for arm in self._world.arms}

    def actions(self, arrivals: Mapping[str, Arrival]) -> NDArray[np.float64]:
        """Shape (arms, 7). `arrivals`: the commands of the arms that are driven; the others hold, gripper included."""
        return np.stack([self._action(arm, arrivals.get(arm)) for arm in self._world.arms])

    def _action(self, arm: str, arrival: Arrival | None) -> NDArray[np.float64]:
        if arrival is None:
            pose, gripper = self._hold(arm)
        else:
            pose, gripper = arrival.target_tool_in_base, arrival.command.gripper
            self._held.pop(arm, None)
            self._gripper[arm] = gripper
        return self._world.action_for(arm, pose, gripper)

    def _hold(self, arm: str) -> tuple[Pose, float]:
        if arm not in self._held:
            self._held[arm] = (self._world.tool_pose_in_base(arm), self._gripper[arm])
        return self._held[arm]
