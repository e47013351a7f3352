"""50 worlds of every task, stepped together: over the bus, in this process, and bare; and robosuite beside them.

"Ours" is RolloutClient.step through a real router to a real replica: actions there; observations, subtasks, success and
failure back. The same requests are answered in this process as well, and what the bus adds to that is the wire's share.
Bare is mujoco.batch.Batch.step of the same scene from the very same states: no controller, nothing observed; torques
and finger targets are held at what our controller ended the tick with, so that the physics has nearly the same contacts
to solve. All three take turns, tick by tick, along recorded episodes of scripted experts, ten worlds an episode.
Each tick counts to one of several series, and the spread is that of the series.

robosuite steps one environment a process; its users run as many processes as they have cores.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray
from report import Bar, report, spread
from support.recorded import record
from support.robosuite import Steps, robosuite

from mart.protocol import keys
from mart.protocol.messages import RolloutRequest
from mart.protocol.tasks import task_names
from mart.protocol.vocabulary import ServiceKind
from mart.rollouts.client import RolloutClient
from mart.runtime.bus import Bus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.sim.rollout.rollout_server import RolloutServer
from mart.sim.world import World, osc

ENDPOINT = "tcp/127.0.0.1:17561"
REPLICA = "bench"
WORLDS = 50
EPISODES = 5
MOST_TICKS = 250
SERIES = 5
PEER_STEPS = 60

Times = NDArray[np.float64]  # milliseconds, one a tick


@dataclass(frozen=True)
class Measured:
    over_bus: Times
    in_process: Times
    bare: Times


def main() -> None:
    tasks = sys.argv[1:] or task_names()
    with services() as bus:
        measured = {task: measure(bus, task) for task in tasks}
    alone, together = peers()
    metrics: dict[str, float] = {}
    bars = []
    for task, times in measured.items():
        ours, bare = series(times.over_bus), series(times.bare)
        wire = (ours - series(times.in_process)) / ours
        ratio = bare / ours
        metrics |= spread(f"{task}_step_ms", ours.tolist())
        metrics |= spread(f"{task}_bare_ms", bare.tolist())
        metrics |= spread(f"{task}_share_of_bare", ratio.tolist())
        metrics |= spread(f"{task}_wire_share", wire.tolist())
        times_faster = float(np.median(alone.step_ms)) / (float(np.median(ours)) / WORLDS)
        bars += [
            Bar.at_least(f"{task}: share of bare Batch.step", float(np.median(ratio)), 0.8),
            Bar.at_most(f"{task}: the wire's share", float(np.median(wire)), 0.10),
            Bar.at_least(f"{task}: times robosuite's rate", times_faster, 15.0),
        ]
        metrics[f"{task}_times_two_robosuites"] = float(
            np.median(together.step_ms) / 2 / (np.median(ours) / WORLDS)
        )
    report(
        "rollout",
        metrics={**metrics, "worlds": WORLDS},
        peer={
            "name": f"robosuite {alone.version} TwoArmLift, one environment a process",
            **spread("step_ms", alone.step_ms),
            **spread("step_beside_another_ms", together.step_ms),
        },
        bars=bars,
    )


def measure(bus: Bus, task: str) -> Measured:
    world = World.build(task)
    episodes = [record(world, seed) for seed in range(EPISODES)]
    ticks = min(MOST_TICKS, *map(len, episodes))
    of_world = [number % EPISODES for number in range(WORLDS)]
    actions = np.stack([episodes[number].actions[:ticks] for number in of_world], axis=1)
    states = np.stack([episodes[number].states[:ticks] for number in of_world], axis=1)
    controls = np.stack([episodes[number].controls[:ticks] for number in of_world], axis=1)
    bare_batch = Batch(world.model, WORLDS)
    server = RolloutServer()
    times: list[list[float]] = []
    with RolloutClient(bus, [REPLICA]) as client:
        client.reset(task, of_world)
        begin = RolloutRequest(reset=RolloutRequest.Reset(task=task, control_hz=20.0, seeds=of_world))
        session = server.answer(begin, 0.0).session
        for tick in range(ticks):
            step = RolloutRequest.Step(session=session, actions=actions[tick].tobytes())
            turns: list[Callable[[], object]] = [
                partial(client.step, actions[tick]),
                partial(server.answer, RolloutRequest(step=step), 0.0),
                partial(bare_step, bare_batch, states[tick], controls[tick], world.substeps),
            ]
            times.append(in_turn(turns, tick))
    return Measured(*np.array(times).T)


def in_turn(calls: list[Callable[[], object]], tick: int) -> list[float]:
    """Milliseconds of each, in their order; another one goes first every time."""
    took = [0.0] * len(calls)
    for place in range(len(calls)):
        number = (place + tick) % len(calls)
        begun_ns = time.perf_counter_ns()
        inner = calls[number]()
        took[number] = inner if isinstance(inner, float) else (time.perf_counter_ns() - begun_ns) / 1e6
    return took


def bare_step(
    batch: Batch, states: NDArray[np.float64], controls: NDArray[np.float64], substeps: int
) -> float:
    """Milliseconds of the step alone."""
    batch.state[:] = states
    batch.ctrl[:] = controls
    mujoco.set_mjcb_control(None)
    try:
        begun_ns = time.perf_counter_ns()
        batch.step(nstep=substeps)
        return (time.perf_counter_ns() - begun_ns) / 1e6
    finally:
        osc.install()


def series(times: Times) -> Times:
    """Means of every SERIES-th tick: each runs through whole episodes."""
    return np.array([times[first::SERIES].mean() for first in range(SERIES)])


def peers() -> tuple[Steps, Steps]:
    """robosuite alone, then two processes of it at once."""
    with robosuite() as one, robosuite() as other:
        alone = one.steps(PEER_STEPS)
        one.begin(PEER_STEPS)
        other.begin(PEER_STEPS)
        first, second = one.end(), other.end()
    return alone, Steps(first.version, first.step_ms + second.step_ms, first.bare_ms + second.bare_ms)


@contextlib.contextmanager
def services() -> Iterator[Bus]:
    """A router and a replica, each a process of its own."""
    with (
        mart("router", "--listen", ENDPOINT),
        mart("replica", "--name", REPLICA),
        ZenohBus.connect(ENDPOINT) as bus,
    ):
        up = threading.Event()
        with contextlib.closing(bus.watch(keys.alive(ServiceKind.REPLICA, REPLICA), lambda *_: up.set())):
            if not up.wait(60):
                raise SystemExit("the replica did not come up within a minute")
        yield bus


@contextlib.contextmanager
def mart(*command: str) -> Iterator[None]:
    environment = {**os.environ, "MART_ROUTER": ENDPOINT, "MART_LOG_LEVEL": "WARNING", "MART_NICENESS": "0"}
    process = subprocess.Popen([Path(sys.executable).with_name("mart"), *command], env=environment)
    try:
        yield
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait()


if __name__ == "__main__":
    main()
