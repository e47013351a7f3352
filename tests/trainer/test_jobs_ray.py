"""Jobs on a real Ray cluster of two nodes."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from ray.cluster_utils import Cluster

from mart.protocol.bus.zenoh_bus import ZenohBus
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import JOB_STATE_CANCELLED, JOB_STATE_DONE, JOB_STATE_RUNNING
from mart.trainer.jobs.executors.ray import RayExecutor
from tests.support.processes import free_port, running_router
from tests.trainer.conftest import Recorded
from tests.trainer.test_jobs import Client, trainer

pytestmark = pytest.mark.timeout(300)  # Ray's processes take their time on a busy machine


@contextlib.contextmanager
def cluster(port: int, nodes: int) -> Iterator[Cluster]:
    """Nodes of one processor each, on this machine, the head at `port`."""
    head = {"num_cpus": 1, "include_dashboard": False, "gcs_server_port": port}
    running = Cluster(initialize_head=True, head_node_args=head)
    try:
        for _ in range(nodes - 1):
            running.add_node(num_cpus=1)
        yield running
    finally:
        running.shutdown()  # type: ignore[no-untyped-call]


@pytest.fixture
def client(episodes: Recorded, tmp_path: Path) -> Iterator[tuple[Client, str]]:
    (tmp_path / "episodes").symlink_to(episodes.root)
    with running_router() as endpoint, ZenohBus.connect(endpoint) as bus:
        yield Client(bus, "trainer-1"), endpoint


def test_a_sweep_is_spread_over_the_nodes(client: tuple[Client, str], tmp_path: Path) -> None:
    asked, endpoint = client
    with (
        cluster(free_port(), nodes=2) as nodes,
        trainer(endpoint, tmp_path, "trainer-1", "--ray", nodes.address),
    ):
        (long,) = asked.submit("BC", executor="ray", preset="fast")
        (short,) = asked.submit("BC", executor="ray")
        assert asked.wait_until_over(short.id).job.state == JOB_STATE_DONE
        assert asked.details(long.id).job.state == JOB_STATE_RUNNING  # beside the other: there are two nodes
        asked.ask(cancel={"job": long.id})
        assert asked.details(long.id).job.state == JOB_STATE_CANCELLED


@pytest.mark.parametrize("address", ["", "head", "head:", ":6379", "ray://head:10001", "head:70000", "auto"])
def test_an_address_of_another_form_is_refused(address: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="HOST:PORT"):
        RayExecutor(address, tmp_path / "log", lambda _: None)
