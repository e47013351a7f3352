"""Name numbers as LeRobot wants them: one float a name, no slash in it, units in the name's place. Pure."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import Task

ACTION_NAMES = ("x", "y", "z", "turn_x", "turn_y", "turn_z", "gripper")
_OPEN = 100.0  # LeRobot's grippers: 0 closed … 100 open

Array = NDArray[np.float64]


def observation_names(task: Task, arm: str) -> tuple[str, ...]:
    """Return a name for each number that the arm's operator is shown: `arm0.tool_position_in_base.0` and so on."""
    return tuple(
        f"{one.name.replace('/', '.')}.{index}"
        for one in task.observations_of(arm)
        for index in range(math.prod(one.shape))
    )


def observation_floats(task: Task, arm: str, shown: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Return the numbers under the names of `observation_names`; shown: values by the task's names, flat."""
    numbers = [float(value) for one in task.observations_of(arm) for value in shown[one.name]]
    return dict(zip(observation_names(task, arm), numbers, strict=True))


def action_numbers(action: Mapping[str, object]) -> Array:
    """Return an action's 7 numbers, clipped to [-1, 1]; raises InvalidInput for a missing or strange one."""
    missing = [name for name in ACTION_NAMES if name not in action]
    if missing:
        raise InvalidInput(
            f"The action lacks {', '.join(missing)}; give {', '.join(ACTION_NAMES)}, each from -1 to 1. "
            f"It has {', '.join(map(str, action)) or 'nothing'}."
        )
    try:
        numbers = np.array([float(action[name]) for name in ACTION_NAMES])  # type: ignore[arg-type]  # anybody's
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"The action holds what is no number: {error}.") from error
    if not np.isfinite(numbers).all():
        raise InvalidInput(f"The action holds NaN or infinity: {numbers.tolist()}.")
    return np.clip(numbers, -1.0, 1.0)


@dataclass(frozen=True)
class LeaderNames:
    """Say how an arm's joints are called by the robot that it leads, and where that robot counts 0.

    joints: a name for each joint in order; a minus before it turns the sign, an empty one leaves the joint out. None:
    joint1.pos, joint2.pos, … zeros_deg: what the robot says where the joint is at 0; None: 0 everywhere. gripper: empty
    leaves it out.
    """

    joints: Sequence[str] | None = None
    zeros_deg: Sequence[float] | None = None
    gripper: str = "gripper.pos"

    def names(self, joint_count: int) -> tuple[str, ...]:
        """Return the names of an action, the gripper's last; raises InvalidInput where they do not fit the arm."""
        self._zeros(joint_count)
        names = [name.removeprefix("-") for name in self._joints(joint_count) if name.removeprefix("-")]
        names += [self.gripper] if self.gripper else []
        again = sorted({name for name in names if names.count(name) > 1})
        if again or not names:
            raise InvalidInput(
                f"Names were given twice: {', '.join(again)}."
                if again
                else "Every name was left empty; give one."
            )
        return tuple(names)

    def action(self, joint_positions: Sequence[float], gripper: float) -> dict[str, float]:
        """Return joints in degrees and the gripper, 0 closed … 100 open, from radians and 0 open … 1 closed."""
        joints = self._joints(len(joint_positions))
        zeros = self._zeros(len(joint_positions))
        action = {
            name.removeprefix("-"): zero + math.degrees(position) * (-1.0 if name.startswith("-") else 1.0)
            for name, zero, position in zip(joints, zeros, joint_positions, strict=True)
            if name.removeprefix("-")
        }
        if self.gripper:
            action[self.gripper] = _OPEN * (1.0 - min(max(gripper, 0.0), 1.0))
        return action

    def _joints(self, count: int) -> Sequence[str]:
        if not self.joints:
            return [f"joint{number}.pos" for number in range(1, count + 1)]
        return _fitting("joints", self.joints, count)

    def _zeros(self, count: int) -> Sequence[float]:
        return _fitting("zeros_deg", self.zeros_deg, count) if self.zeros_deg else [0.0] * count


def _fitting(name: str, given: Sequence, count: int) -> Sequence:  # type: ignore[type-arg]  # of names or of numbers
    if len(given) != count:
        raise InvalidInput(
            f"{name} has {len(given)} entries; the arm has {count} joints. Give one for each, '' for one to leave out."
        )
    return given
