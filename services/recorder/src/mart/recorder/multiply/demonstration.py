"""Read a recorded episode as ways to carry on: where each arm was led, and where things lay meanwhile. Pure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.protocol.pose import Array, quaternion_exp, quaternion_multiply, rotate
from mart.protocol.tasks import Arm, Task
from mart.recorder.multiply.transport import between

_POSITION, _QUATERNION = "/position_in_world", "/quaternion_in_world"
_TOOL = "/tool_position_in_world"
_CLOSED = 0.5


@dataclass(frozen=True)
class ToolInWorld:
    """Say where a tool is to be, in the world, and how far its gripper is to close."""

    position: Array
    quaternion: Array
    gripper: float


@dataclass(frozen=True)
class Way:
    """Hold where an arm was led over T ticks, in the world: what was asked for, not what was reached.

    positions: float64[T, 3]. quaternions: float64[T, 4], wxyz. grippers: float64[T], 0 open … 1 closed.
    start: where the tool was before the first tick.
    """

    positions: Array
    quaternions: Array
    grippers: Array
    start: ToolInWorld

    def __len__(self) -> int:
        return len(self.positions)

    def at(self, tick: float) -> ToolInWorld:
        """Return where the arm was led at a tick, which may lie between two; before the first one, where it began."""
        if tick < 0.0:
            return self.start
        row = min(int(tick), len(self) - 1)
        following, part = min(row + 1, len(self) - 1), tick - row
        position, quaternion = self.positions[row], self.quaternions[row]
        if part > 0.0 and following > row:
            position = position + part * (self.positions[following] - position)
            quaternion = between(quaternion, self.quaternions[following], part)
        return ToolInWorld(position, quaternion, float(self.grippers[row]))

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Whether the gripper was to be closed, by tick."""
        closed: NDArray[np.bool_] = self.grippers > _CLOSED
        return closed


@dataclass(frozen=True)
class ThingTrack:
    """Hold where a thing was, T + 1 states, in the world. quaternions: None where only its position is observed."""

    positions: Array
    quaternions: Array | None


@dataclass(frozen=True)
class Demonstration:
    """Hold one episode as it is carried on. name: of its file. subtasks: by name, bool[T + 1]."""

    name: str
    ways: Mapping[str, Way]
    things: Mapping[str, ThingTrack]
    subtasks: Mapping[str, NDArray[np.bool_]]

    @property
    def ticks(self) -> int:
        return len(next(iter(self.ways.values())))


def demonstration_of(data: EpisodeData, task: Task, name: str) -> Demonstration:
    """Read an episode's arrays, all observations of the task among them."""
    return Demonstration(
        name=name,
        ways={arm.name: _way(data, index, arm) for index, arm in enumerate(task.arms)},
        things={thing: track_of(thing, data.observations) for thing in things_of(task)},
        subtasks=data.subtasks,
    )


def things_of(task: Task) -> tuple[str, ...]:
    """Return the names of what is observed to lie somewhere in the world; tools are none of them."""
    return tuple(
        one.name.removesuffix(_POSITION)
        for one in task.observations
        if one.name.endswith(_POSITION) and not one.name.endswith(_TOOL)
    )


def track_of(thing: str, observations: Mapping[str, Array]) -> ThingTrack:
    """Return where a thing was, from observations by their names."""
    return ThingTrack(observations[thing + _POSITION], observations.get(thing + _QUATERNION))


def _way(data: EpisodeData, index: int, arm: Arm) -> Way:
    limits = arm.kind.limits
    positions, quaternions = [], []
    for tick, action in enumerate(data.actions[:, index]):
        position = data.tool_positions_in_base[tick, index] + action[:3] * limits.step_m
        turn = quaternion_exp(action[3:6] * limits.step_rad)
        quaternion = quaternion_multiply(turn, data.tool_quaternions_in_base[tick, index])
        led = tool_in_world(arm, position, quaternion)
        positions.append(led.position)
        quaternions.append(led.quaternion)
    start = tool_in_world(arm, data.tool_positions_in_base[0, index], data.tool_quaternions_in_base[0, index])
    return Way(np.array(positions), np.array(quaternions), (data.actions[:, index, 6] + 1.0) / 2.0, start)


def tool_in_world(
    arm: Arm, position_in_base: Array, quaternion_in_base: Array, gripper: float = 0.0
) -> ToolInWorld:
    """Return where a tool is in the world, of a pose in its arm's base frame."""
    base = arm.pose_base_in_world
    return ToolInWorld(
        base.position + rotate(base.quaternion_wxyz, position_in_base),
        quaternion_multiply(base.quaternion_wxyz, quaternion_in_base),
        gripper,
    )
