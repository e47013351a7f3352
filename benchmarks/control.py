"""A control step of two Pandas: ours beside bare MuJoCo of the same scene, and beside robosuite's TwoArmLift.

Ours is World.step: 25 substeps of 2 ms with the controller in each, then poses, success and shadows. Bare is
mj_step(nstep=25) from the very same states with no callback, torques and finger targets held at what our controller
ended the tick with, so that the physics has nearly the same contacts to solve. Both follow a recorded episode of two
scripted experts (reach, grasp, lift), tick by tick in turns; robosuite takes its turn after each round. Times are the
thread's processor time, so that other programs on a shared machine count little.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
import venv
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from report import Bar, report

from mart.sim.experts import Expert, get_skill
from mart.sim.world import World, osc

HERE = Path(__file__).parent
PEER = HERE / "peers" / "robosuite"
PEER_VENV = HERE.parent / ".venv-peers" / "robosuite"
TASK = "two_arm_multi_cube_lifting"
ROUNDS = 7
PEER_STEPS = 20


@dataclass(frozen=True)
class Tick:
    state: bytes
    actions: NDArray[np.float64]
    controls_after: NDArray[np.float64]  # torques and finger targets, shape (nu,)


def main() -> None:
    world = World.build(TASK)
    episode = record(world)
    rounds = []
    with robosuite() as peer_steps:
        for _ in range(ROUNDS):
            ours, bare = follow(world, episode)
            rounds.append((ours, bare, peer_steps(PEER_STEPS)))
    ours_ms = [median(ours) for ours, _, _ in rounds]
    bare_ms = [median(bare) for _, bare, _ in rounds]
    peer_ms = [median(peer["step_ms"]) for _, _, peer in rounds]
    over_bare = [sum(ours) / sum(bare) for ours, bare, _ in rounds]
    report(
        "control",
        metrics={
            **spread("step_ms", ours_ms),
            **spread("bare_mj_step_ms", bare_ms),
            **spread("over_bare", over_bare),
            "ticks": len(episode),
            "rounds": ROUNDS,
        },
        peer={
            "name": f"robosuite {rounds[0][2]['version']} TwoArmLift",
            **spread("step_ms", peer_ms),
            **spread("bare_mj_step_ms", [median(peer["bare_ms"]) for _, _, peer in rounds]),
        },
        bars=[
            Bar.at_least("times faster than robosuite", median(peer_ms) / median(ours_ms), 8.0),
            Bar.at_most("times bare mj_step of our scene", median(over_bare), 1.10),
        ],
    )


def record(world: World) -> list[Tick]:
    """States and the actions taken in them, until both cubes are up."""
    world.reset(0)
    experts = [Expert(world.task, arm, get_skill("expert"), np.random.default_rng(0)) for arm in world.arms]
    targets = [world.tool_pose_in_base(arm) for arm in world.arms]
    episode: list[Tick] = []
    while not world.progress().success:
        actions = []
        for index, (arm, expert) in enumerate(zip(world.arms, experts, strict=True)):
            intent = expert.act(world.observations_for(arm), world.sim_time_s)
            if intent.engaged:
                targets[index] = intent.target_tool_in_base
            actions.append(world.action_for(arm, targets[index], intent.gripper))
        state = world.integration_state()
        world.step(actions)
        episode.append(Tick(state, np.array(actions), world.data.ctrl.copy()))
    return episode


def follow(world: World, episode: list[Tick]) -> tuple[list[float], list[float]]:
    """Milliseconds of every tick: our step, and bare mj_step."""
    ours, bare = [], []
    for number, tick in enumerate(episode):
        # In turns, so that neither always finds the caches warm.
        for ours_now in (True, False) if number % 2 else (False, True):
            world.set_integration_state(tick.state)
            if ours_now:
                ours.append(milliseconds(partial(world.step, tick.actions)))
            else:
                bare.append(bare_step_ms(world, tick.controls_after))
    return ours, bare


def bare_step_ms(world: World, controls: NDArray[np.float64]) -> float:
    world.data.ctrl[:] = controls
    mujoco.set_mjcb_control(None)
    try:
        return milliseconds(partial(mujoco.mj_step, world.model, world.data, 25))
    finally:
        osc.install()


def milliseconds(call: Callable[[], None]) -> float:
    begun_ns = time.thread_time_ns()
    call()
    return (time.thread_time_ns() - begun_ns) / 1e6


@contextmanager
def robosuite() -> Iterator[Callable[[int], dict[str, Any]]]:
    """A peer process that times so many of its steps whenever asked."""
    process = subprocess.Popen(
        [peer_python(), PEER / "control.py"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdin is not None
    assert process.stdout is not None

    def ask(steps: int) -> dict[str, Any]:
        print(steps, file=process.stdin, flush=True)
        for line in process.stdout or ():
            if line.startswith("{"):  # robosuite prints notes of its own
                answer: dict[str, Any] = json.loads(line)
                return answer
        raise SystemExit(
            f"robosuite ended with code {process.wait()}: run {PEER / 'control.py'} by hand to see why."
        )

    try:
        yield ask
    finally:
        process.stdin.close()
        process.wait(timeout=30)
        process.stdout.close()


def peer_python() -> Path:
    """The peer's own environment, made at the first call."""
    python = PEER_VENV / "bin" / "python"
    ready = PEER_VENV / "ready"
    if not ready.is_file():
        print(f"making {PEER_VENV} …", file=sys.stderr)
        venv.create(PEER_VENV, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "-q", "-r", PEER / "requirements.txt"], check=True)
        ready.touch()
    return python


def spread(name: str, values: list[float]) -> dict[str, float]:
    """Median, smallest and largest of the rounds."""
    return {name: median(values), f"{name}_min": min(values), f"{name}_max": max(values)}


if __name__ == "__main__":
    main()
