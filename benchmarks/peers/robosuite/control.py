"""robosuite's TwoArmLift, two Pandas under its operational-space controller, timed block by block.

Runs in its own virtual environment (requirements.txt beside it). Reads a number of control steps a line from standard
input; answers each with one line of JSON: milliseconds of every control step, and of the bare 25 x mj_step beside.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable

import mujoco
import numpy as np
import robosuite

WARM_UP_STEPS = 20  # numba compiles the controller's functions
SUBSTEPS = 25


def main() -> None:
    environment = robosuite.make(
        "TwoArmLift",
        robots=["Panda", "Panda"],
        has_renderer=False,
        has_offscreen_renderer=False,
        use_camera_obs=False,
        control_freq=20,
        horizon=1_000_000,
    )
    environment.reset()
    random = np.random.default_rng(0)
    low, high = environment.action_spec

    def step() -> None:
        environment.step(0.2 * random.uniform(low, high))

    def bare() -> None:
        mujoco.mj_step(environment.sim.model._model, environment.sim.data._data, SUBSTEPS)  # noqa: SLF001

    for _ in range(WARM_UP_STEPS):
        step()
    for line in sys.stdin:
        times = [(milliseconds(step), milliseconds(bare)) for _ in range(int(line))]
        step_ms, bare_ms = zip(*times, strict=True)
        answer = {"version": robosuite.__version__, "step_ms": step_ms, "bare_ms": bare_ms}
        print(json.dumps(answer), flush=True)


def milliseconds(call: Callable[[], None]) -> float:
    """Of this thread's processor time, so that other programs on a shared machine do not count."""
    begun_ns = time.thread_time_ns()
    call()
    return (time.thread_time_ns() - begun_ns) / 1e6


if __name__ == "__main__":
    main()
