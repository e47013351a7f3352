"""Worlds on two real replicas, through a real router."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import pytest

from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.tasks import get_task, task_names
from mart.rollouts.client import RolloutClient
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.sim.world import World, WorldBatch
from tests.support.processes import Running, running_router, running_service

TICKS = 5
SEEDS = (3, 2**64 - 1, 0, 77, 5)


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    with running_router() as endpoint:
        yield endpoint


@pytest.fixture(scope="module")
def replicas(endpoint: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, ...]]:
    folder = tmp_path_factory.mktemp("replicas")
    with (
        running_service(["replica", "--name", "one"], endpoint, folder, kind="replica", id="one"),
        running_service(["replica", "--name", "two"], endpoint, folder, kind="replica", id="two"),
    ):
        yield "one", "two"


@pytest.mark.parametrize("task", task_names())
def test_the_same_seeds_and_actions_give_the_same_bytes_everywhere(
    task: str, endpoint: str, replicas: tuple[str, ...]
) -> None:
    """Spread over two processes, as a batch in this one, and each world alone."""
    arms = len(get_task(task).arms)
    actions = np.random.default_rng(1).uniform(-1, 1, (TICKS, len(SEEDS), arms, 7))
    alone = World.build(task)
    together = WorldBatch(alone, len(SEEDS), threads=2)
    together.reset(SEEDS)
    everyone = np.ones(len(SEEDS), bool)
    with ZenohBus.connect(endpoint) as bus, RolloutClient(bus, replicas) as client:
        stood = [client.reset(task, SEEDS, integration_states=True)]
        stood += [client.step(action) for action in actions]
    for action in actions:
        together.step(action, everyone)
    last = together.standing(integration_states=True)
    assert stood[-1].integration_states is not None
    assert last.integration_states is not None
    assert stood[-1].integration_states.tobytes() == last.integration_states.tobytes()
    for name, seen in last.observations.items():
        assert stood[-1].observations[name].tobytes() == seen.tobytes(), name
    for number, seed in enumerate(SEEDS):
        alone.reset(seed)
        for action in actions[:, number]:
            alone.step(action)
        assert last.integration_states[number].tobytes() == alone.integration_state()
        for name, seen in alone.observations().items():
            assert last.observations[name][number].tobytes() == seen.tobytes(), name
        progress = alone.progress()
        assert last.subtasks[number].tolist() == list(progress.subtasks.values())
        assert last.reasons[number] == (progress.failed or "")


def test_a_replica_that_was_restarted_says_so(endpoint: str, tmp_path: Path) -> None:
    with ZenohBus.connect(endpoint) as bus, RolloutClient(bus, ["three"]) as client:
        with replica(endpoint, tmp_path) as first:
            client.reset("two_arm_multi_cube_lifting", [1])
            first.kill()
        with replica(endpoint, tmp_path):
            with pytest.raises(NotFound, match="restarted"):
                client.step(np.zeros((1, 2, 7)))
            with pytest.raises(Conflict, match="reset them"):
                client.step(np.zeros((1, 2, 7)))
            client.reset("two_arm_multi_cube_lifting", [1])
            assert client.step(np.zeros((1, 2, 7))).sim_time_s.tolist() == pytest.approx([0.05])


def replica(endpoint: str, folder: Path) -> AbstractContextManager[Running]:
    return running_service(["replica", "--name", "three"], endpoint, folder, kind="replica", id="three")


def test_a_batch_that_is_too_large_is_refused_and_smaller_ones_go_on(
    endpoint: str, replicas: tuple[str, ...]
) -> None:
    with ZenohBus.connect(endpoint) as bus, RolloutClient(bus, replicas) as client:
        with pytest.raises(InvalidInput, match="give 1 to 4096"):
            client.reset("two_arm_multi_cube_lifting", range(9000))
        client.reset("two_arm_multi_cube_lifting", [1, 2])
