"""Say what an operator is: it is shown what an arm's operator sees and says where the tool should go. Pure."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mart.protocol.messages import Cue
from mart.protocol.pose import Pose, quaternion_exp, quaternion_multiply
from mart.protocol.tasks import Limits, Task

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ToolTarget:
    """Say where an operator wants a tool: its pose in the arm's base frame, and the gripper, 0 (open) to 1 (closed).

    While not `engaged` the clutch is let go, and the arm should hold. The room moves the arm at most one step a tick
    (`kind.limits` of the task's arm) towards the pose, and never out of the arm's workspace.
    """

    pose_tool_in_base: Pose
    gripper: float = 0.0
    engaged: bool = True


@dataclass(frozen=True, eq=False)
class SeatView:
    """What an operator is shown at one tick.

    `observations`: float64 by the task's names, each of the shape that the task gives it. `poses_tool_in_base`:
    measured, for each arm that the operator drives. `sim_time_s` counts from the reset of the world.
    `integration_state`: MuJoCo's, little-endian float64, from which `mart.render` draws pictures with the room's model.
    """

    task: Task
    episode: int
    tick: int
    sim_time_s: float
    observations: Mapping[str, Array]
    poses_tool_in_base: Mapping[str, Pose]
    integration_state: bytes = b""

    def step(
        self, arm: str, step_m: ArrayLike = (0, 0, 0), turn_rad: ArrayLike = (0, 0, 0), gripper: float = 0.0
    ) -> ToolTarget:
        """Return the target a step away from where `arm`'s tool is: metres and a rotation vector in the base frame."""
        return ToolTarget(_moved(self.poses_tool_in_base[arm], step_m, turn_rad), gripper)


class Operator(ABC):
    """Drive one arm, or several together: a script, a policy, or a program of your own.

    >>> class Riser(Operator):
    ...     def act(self, view):
    ...         return {arm: view.step(arm, (0, 0, 0.01)) for arm in view.poses_tool_in_base}
    """

    def prepare(self) -> None:  # noqa: B027 - most have nothing to load
        """Load and warm up what takes long, before the seat is taken: once it is, people wait for every answer.

        Called once, on the thread that calls the other methods afterwards.
        """

    def begin(self, episode: int) -> None:  # noqa: B027 - most have nothing to forget
        """Forget what was: the world has been reset, or the seat was just taken. `episode` is the room's count."""

    def on_cue(self, cue: Cue, arm: str) -> None:  # noqa: B027 - most have an `ObedientOperator` around them
        """Hear a word from the person who drives `arm`, a partner's, before the next `act`.

        Do as told, or not: an operator that says nothing of it ignores cues. See `ObedientOperator` for one that obeys.
        """

    @abstractmethod
    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return a target for every arm that this operator drives.

        Called once for each new state of the world, or once for each of its own ticks where it has a slower rate.
        """


def target_from_action(
    measured_pose_tool_in_base: Pose, action: ArrayLike, limits: Limits
) -> tuple[Pose, float]:
    """Return the target pose in the arm's base and the gripper (0 open … 1 closed) that an action asks for.

    `action`: 7 numbers in [-1, 1], 3 of translation, 3 of rotation, 1 of the gripper (-1 open … 1 closed). The inverse
    of what the sim applies (docs/protocol.md, section "Commands"): within the limits and the workspace the applied
    action is this action again.
    """
    numbers = np.asarray(action, dtype=np.float64)
    pose = _moved(measured_pose_tool_in_base, limits.step_m * numbers[:3], limits.step_rad * numbers[3:6])
    return pose, min(max((float(numbers[6]) + 1.0) / 2.0, 0.0), 1.0)


def _moved(pose: Pose, step_m: ArrayLike, turn_rad: ArrayLike) -> Pose:
    turn = quaternion_exp(np.asarray(turn_rad, dtype=np.float64))
    return Pose(
        pose.position + np.asarray(step_m, dtype=np.float64), quaternion_multiply(turn, pose.quaternion_wxyz)
    )
