"""What holds for an episode of every task: it replays to the same bits, and no tick of it is dear."""

from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.tasks import task_names
from mart.sim.world import World
from tests.sim.tasks.driving import Watched, watch

_PIECE_TICKS = 60


@pytest.fixture(scope="module", params=task_names())
def watched(request: pytest.FixtureRequest) -> Watched:
    """An episode of experts."""
    return watch(World.build(request.param), seed=4)


@pytest.mark.slow
def test_it_replays_to_the_same_bits_from_any_state_of_it(watched: Watched) -> None:
    """What has happened so far is part of the state: dirt that was wiped away, a hammer that was handed over."""
    replica = World.build(watched.task)
    last = len(watched.actions) - 1
    for start in np.linspace(0, max(0, last - _PIECE_TICKS), 3).astype(int):
        replica.set_integration_state(watched.states[start])
        for tick in range(start, min(start + _PIECE_TICKS, last)):
            replica.step(watched.actions[tick])
            assert replica.integration_state() == watched.states[tick + 1]
    replica.step(watched.actions[-1])
    assert replica.progress().subtasks == watched.progress.subtasks


@pytest.mark.slow
def test_no_moment_of_a_grasp_is_dear(watched: Watched) -> None:
    """In counts, which are the same on every machine: rows of the constraint problem, iterations of its solver."""
    assert max(watched.constraint_rows) < 200
    assert max(watched.solver_iterations) < 40
    assert np.mean(watched.solver_iterations) < 4
