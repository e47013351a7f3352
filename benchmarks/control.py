"""A control step of every task: ours beside bare MuJoCo of the same scene, and beside robosuite's TwoArmLift.

Beside both stands World.step, success judged and all; bare is mj_step(nstep=25). World.drive, the part of it that
controls the arms (the command taken, 25 substeps of 2 ms with the controller in each, the new poses, the guard against
divergence), has a bar of its own: what is left is the task's judgement, in Python. Bare starts from the very same
states with no callback, torques and finger targets held at what our controller ended the tick with, so that the
physics has nearly the same contacts to solve. All follow a recorded episode of scripted experts, tick by tick in turns;
robosuite takes its turn after each round. Times are the thread's processor time, so that other programs on a shared
machine count little.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from statistics import median

import mujoco
import numpy as np
from report import Bar, report, spread
from support.recorded import Recording, record
from support.robosuite import Robosuite, Steps, robosuite

from mart.protocol.tasks import arm_counts, task_names
from mart.sim.world import World, osc

ARMS = (2, 3)
ROUNDS = 7
TICKS = 66  # a round, spread over the episode
PEER_STEPS = 20


@dataclass(frozen=True)
class Round:
    """Milliseconds, one a tick."""

    step: tuple[float, ...]
    drive: tuple[float, ...]
    bare: tuple[float, ...]
    peer: Steps


def main() -> None:
    metrics: dict[str, float] = {"rounds": ROUNDS}
    bars: list[Bar] = []
    peers: list[Steps] = []
    with robosuite() as peer:
        for task in sys.argv[1:] or task_names():
            for arms in sorted(set(ARMS) & set(arm_counts(task))):
                rounds = measure(World.build(task, arms=arms), peer)
                step_ms = [median(taken.step) for taken in rounds]
                over_bare = [sum(taken.step) / sum(taken.bare) for taken in rounds]
                control_over_bare = [sum(taken.drive) / sum(taken.bare) for taken in rounds]
                name = f"{task}_{arms}_arms"
                metrics |= {
                    **spread(f"{name}_step_ms", step_ms),
                    **spread(f"{name}_step_over_bare", over_bare),
                    **spread(f"{name}_control_over_bare", control_over_bare),
                }
                steps = [taken.peer for taken in rounds]
                faster = median(median(taken.step_ms) for taken in steps) / median(step_ms)
                bars += [
                    Bar.at_least(f"{task}, {arms} arms: times robosuite", faster, 8.0),
                    Bar.at_most(
                        f"{task}, {arms} arms: control, times bare mj_step", median(control_over_bare), 1.10
                    ),
                    Bar.at_most(
                        f"{task}, {arms} arms: all of the step, times bare mj_step", median(over_bare), 1.10
                    ),
                ]
                peers += steps
    report(
        "control",
        metrics,
        peer={
            "name": f"robosuite {peers[0].version} TwoArmLift",
            **spread("step_ms", [median(taken.step_ms) for taken in peers]),
            **spread("bare_mj_step_ms", [median(taken.bare_ms) for taken in peers]),
        },
        bars=bars,
    )


def measure(world: World, peer: Robosuite) -> list[Round]:
    episode = record(world, seed=0)
    return [follow(world, episode, peer) for _ in range(ROUNDS)]


def follow(world: World, episode: Recording, peer: Robosuite) -> Round:
    """Ticks all along the episode, each stepped in three ways."""
    took: list[list[float]] = []
    for tick in np.linspace(0, len(episode) - 1, min(TICKS, len(episode))).astype(int):
        ways = (partial(world.step, episode.actions[tick]), partial(world.drive, episode.actions[tick]))
        took.append([0.0] * 3)
        for place in range(3):  # in turns, so that none always finds the caches warm
            way = (place + len(took)) % 3
            world.set_integration_state(episode.states[tick].tobytes())
            if way < len(ways):
                took[-1][way] = milliseconds(ways[way])
            else:
                world.data.ctrl[:] = episode.controls[tick]
                took[-1][way] = bare_step_ms(world)
    step, drive, bare = zip(*took, strict=True)
    return Round(step, drive, bare, peer.steps(PEER_STEPS))


def bare_step_ms(world: World) -> float:
    mujoco.set_mjcb_control(None)
    try:
        return milliseconds(partial(mujoco.mj_step, world.model, world.data, world.substeps))
    finally:
        osc.install()


def milliseconds(call: Callable[[], object]) -> float:
    begun_ns = time.thread_time_ns()
    call()
    return (time.thread_time_ns() - begun_ns) / 1e6


if __name__ == "__main__":
    main()
