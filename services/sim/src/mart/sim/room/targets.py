"""Work out the action of every arm in one tick: towards its operator's target, or to stay where it was left."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.room.command_validation import ReceivedCommand
from mart.sim.world import World


class Targets:
    """Work out actions towards absolute targets.

    Between two ticks the world stands still, so an action is worked out when its command arrives: the command that
    completes the barrier need not wait for the arithmetic of the others. A held arm has one fixed target, the pose in
    which it was let go: measured anew every tick, it would sink.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._gripper = dict.fromkeys(world.arms, 0.0)
        self._held: dict[str, Pose] = {}
        self._aimed: dict[str, tuple[ReceivedCommand, NDArray[np.float64]]] = {}

    def world_reset(self) -> None:
        """Forget the old targets: arms are elsewhere now, their grippers as the reset left them."""
        self._held.clear()
        self._aimed.clear()
        self._gripper = {arm: self._world.gripper(arm) for arm in self._world.arms}

    def aim(self, received: ReceivedCommand) -> NDArray[np.float64]:
        """Return the action, shape (7,), that this command asks for in the world as it is now."""
        action = self._world.action_for(received.arm, received.target_tool_in_base, received.command.gripper)
        self._aimed[received.arm] = (received, action)
        return action

    def actions(self, commands: Mapping[str, ReceivedCommand]) -> NDArray[np.float64]:
        """Return what is to be done next, shape (arms, 7).

        commands: the commands of the arms that are driven; the others hold, gripper included.
        """
        actions = np.array([self._action(arm, commands.get(arm)) for arm in self._world.arms])
        self._aimed.clear()
        return actions

    def _action(self, arm: str, received: ReceivedCommand | None) -> NDArray[np.float64]:
        if received is None:
            if arm not in self._held:
                self._held[arm] = self._world.tool_pose_in_base(arm)
            return self._world.action_for(arm, self._held[arm], self._gripper[arm])
        self._held.pop(arm, None)
        self._gripper[arm] = received.command.gripper
        known, action = self._aimed.get(arm, (None, None))
        return action if known is received and action is not None else self.aim(received)
