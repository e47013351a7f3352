"""Measure what a world takes of this machine, before its room opens."""

from __future__ import annotations

import os
from statistics import median

import numpy as np

from mart.protocol import clock
from mart.protocol.batch_state import ACTION_SIZE
from mart.sim.room.automatic_rate import SimCost
from mart.sim.world import World

_TICKS = 20
# Beside the world: commands checked and aimed, a state encoded and published, about 1 ms a tick.
_MESSAGES_S = 0.001


def measure(world: World) -> SimCost:
    """Step a world some ticks, which resets it, and return what that takes; some tens of milliseconds."""
    world.reset(0)
    idle = np.zeros((len(world.arms), ACTION_SIZE))
    steps_s, looks_s = [], []
    for _ in range(_TICKS):
        begun_s = clock.monotonic_s()
        status = world.step(idle)
        stepped_s = clock.monotonic_s()
        world.progress(status)
        world.observations()
        world.integration_state()
        steps_s.append(stepped_s - begun_s)
        looks_s.append(clock.monotonic_s() - stepped_s)
    physics = median(steps_s) * world.control_hz
    return SimCost(physics, median(looks_s) + _MESSAGES_S, len(os.sched_getaffinity(0)))
