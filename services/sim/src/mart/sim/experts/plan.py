"""What a scripted operator wants next: a generator that is sent what it sees and yields waypoints."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose

OPEN, CLOSED = 0.0, 1.0


@dataclass(frozen=True)
class Waypoint:
    """Where the tool should go (own base frame) and what the gripper should do; `pace` 1 is the person's own speed."""

    pose_tool_in_base: Pose
    gripper: float
    pace: float = 1.0


@dataclass(frozen=True)
class Sight:
    """What one operator sees at one moment. `arrived`: the tool is at the waypoint that was yielded last."""

    observations: Mapping[str, NDArray[np.float64]]
    sim_time_s: float
    pose_tool_in_base: Pose
    gripper: float
    arrived: bool


Plan = Generator[Waypoint, Sight, None]
Step = Generator[Waypoint, Sight, Sight]
Aim = Callable[[Sight], Waypoint]


def go(sight: Sight, aim: Aim) -> Step:
    """Until the tool is there; the aim follows what is seen."""
    sight = yield aim(sight)
    while not sight.arrived:
        sight = yield aim(sight)
    return sight


def stay(sight: Sight, waypoint: Waypoint, duration_s: float) -> Step:
    """For a while."""
    until_s = sight.sim_time_s + duration_s
    while sight.sim_time_s < until_s:
        sight = yield waypoint
    return sight
