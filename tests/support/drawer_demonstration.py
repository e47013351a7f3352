"""Two operators of the example examples/tasks/two_arm_drawer.toml, each a list of where its tool should be by when."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.world import World

TASK_FILE = Path(__file__).resolve().parents[2] / "examples/tasks/two_arm_drawer.toml"

_OPEN, _CLOSED = 0.0, 1.0
_PULL_M = np.array([0.0, -0.125, 0.0])
_ASIDE_M = np.array([-0.035, 0.005, 0.0])  # where the peg goes, from the drawer's middle
_Goals = dict[str, tuple[NDArray[np.float64], float]]


def demonstrate(world: World, seed: int) -> Iterator[NDArray[np.float64]]:
    """Reset the world, drive it to the end, and yield what was applied at each tick."""
    world.reset(seed)
    bases = {arm.name: arm.pose_base_in_world for arm in world.task.arms}
    for ticks, goals in _steps(world):
        targets = {
            arm: Pose(bases[arm].inverse().transform_points(position), Pose.identity().quaternion_wxyz)
            for arm, (position, _) in goals.items()
        }
        for _ in range(ticks):
            actions = np.array([world.action_for(arm, targets[arm], goals[arm][1]) for arm in world.arms])
            world.step(actions)
            yield actions


def _steps(world: World) -> Iterator[tuple[int, _Goals]]:
    peg, handle, drawer = (
        world.observations()[f"{name}/position_in_world"] for name in ("peg", "handle", "drawer")
    )
    place = drawer + _PULL_M + _ASIDE_M
    yield 30, {"arm0": (peg + _up(0.12), _OPEN), "arm1": (handle + _up(0.10), _OPEN)}
    yield 20, {"arm0": (peg, _OPEN), "arm1": (handle, _OPEN)}
    yield 12, {"arm0": (peg, _CLOSED), "arm1": (handle, _CLOSED)}
    pulled = handle + _PULL_M
    yield 40, {"arm0": (peg + _up(0.16), _CLOSED), "arm1": (pulled, _CLOSED)}
    yield 40, {"arm0": (place + _up(0.16), _CLOSED), "arm1": (pulled, _CLOSED)}
    yield 20, {"arm0": (place + _up(0.07), _CLOSED), "arm1": (pulled, _CLOSED)}
    yield 10, {"arm0": (place + _up(0.07), _OPEN), "arm1": (pulled, _CLOSED)}
    away = place + np.array([-0.12, 0.0, 0.2])
    yield 20, {"arm0": (away, _OPEN), "arm1": (pulled, _CLOSED)}
    yield 15, {"arm0": (away, _OPEN), "arm1": (pulled, _OPEN)}
    yield 20, {"arm0": (away, _OPEN), "arm1": (pulled + _up(0.12), _OPEN)}


def _up(height_m: float) -> NDArray[np.float64]:
    return np.array([0.0, 0.0, height_m])
