"""Ways of software: arms that pick and lift cubes, on straight lines, with nothing simulated."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mart.protocol.tasks import Task, get_task
from mart.recorder.multiply.carried_segment import Placed
from mart.recorder.multiply.demonstration import Demonstration, ThingTrack, ToolInWorld, Way, things_of
from mart.recorder.multiply.transport import yaw_of, yaw_quaternion

CUBES = get_task("two_arm_multi_cube_lifting")
Vector = NDArray[np.float64]

LIFT_M = np.array([0.0, 0.0, 0.15])


def pick_and_lift(name: str, random: np.random.Generator, pauses: tuple[int, int] = (0, 0)) -> Demonstration:
    """Each arm goes to its cube, which lies anywhere, closes after 40 ticks, and lifts it. pauses: ticks before."""
    ways, things, done = {}, {}, {}
    ticks = 120
    for index, arm in enumerate(CUBES.arm_names):
        cube = np.array([random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.02])
        yaw = random.uniform(-0.7, 0.7)
        begin = cube + np.array([*random.uniform(-0.3, 0.3, 2), 0.2])
        closes = 40 + pauses[index]
        lifted = closes + 40
        shares = np.clip((np.arange(ticks) - pauses[index] + 1) / 36.0, 0.0, 1.0)[:, np.newaxis]
        lifts = np.clip((np.arange(ticks) - closes) / 35.0, 0.0, 1.0)[:, np.newaxis]
        positions = begin + shares * (cube - begin) + lifts * LIFT_M
        quaternions = np.tile(yaw_quaternion(yaw), (ticks, 1))
        grippers = (np.arange(ticks) >= closes).astype(float)
        ways[arm] = Way(positions, quaternions, grippers, ToolInWorld(begin, yaw_quaternion(yaw), 0.0))
        track = cube + np.concatenate([np.zeros((1, 3)), lifts * LIFT_M])
        things[f"cube{index}"] = ThingTrack(track, np.tile(yaw_quaternion(yaw), (ticks + 1, 1)))
        done[f"lift_cube{index}"] = np.arange(ticks + 1) >= lifted
    return Demonstration(name, ways, things, done)


def placed(demonstration: Demonstration, tick: int, task: Task = CUBES) -> dict[str, Placed]:
    """Where things are in a state of a demonstration."""
    found = {}
    for thing in things_of(task):
        track = demonstration.things[thing]
        turn = None if track.quaternions is None else yaw_of(track.quaternions[tick])
        found[thing] = Placed(track.positions[tick], turn)
    return found


def done(demonstration: Demonstration, tick: int) -> list[str]:
    """Which subtasks are done in a state of a demonstration."""
    return [name for name, flags in demonstration.subtasks.items() if flags[tick]]
