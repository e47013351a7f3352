"""Jobs on a real Ray cluster of two nodes, whose head is lost in the middle of a sweep."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from ray.cluster_utils import Cluster

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import JOB_STATE_CANCELLED, JOB_STATE_DONE, JOB_STATE_QUEUED, JOB_STATE_RUNNING
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from mart.trainer.jobs.executors.ray import RayExecutor
from mart.trainer.jobs.job_files import LOG
from mart.trainer.train.run_directory import RunDirectory
from tests.support.processes import running_router
from tests.trainer.conftest import Recorded
from tests.trainer.jobs.service.test_trainer_service import Client, trainer, watched, worker_of

# Ray's processes take their time on a busy machine.
pytestmark = [pytest.mark.system, pytest.mark.timeout(300)]


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
def endpoint(episodes: Recorded, tmp_path: Path) -> Iterator[str]:
    (tmp_path / "episodes").symlink_to(episodes.root)
    with running_router() as endpoint:
        yield endpoint


@contextlib.contextmanager
def asking(endpoint: str) -> Iterator[Client]:
    """A client of the trainer."""
    with ZenohBus.connect(endpoint) as bus:
        yield Client(bus, "trainer-1")


def wait_for_another_checkpoint(run: RunDirectory) -> None:
    """The files tell, whether or not the trainer can be asked meanwhile."""
    had, deadline_s = run.checkpointed(), clock.monotonic_s() + 120.0
    while run.checkpointed() == had:
        assert clock.monotonic_s() < deadline_s, (run.path / LOG).read_text()
        clock.sleep_s(0.1)


def test_a_job_goes_through_the_loss_of_the_head(
    endpoint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAY_gcs_rpc_server_reconnect_timeout_s", "5")  # what is left of the cluster ends soon
    port = free_port()
    with contextlib.ExitStack() as stack:
        nodes = stack.enter_context(cluster(port, nodes=2))
        stack.enter_context(trainer(endpoint, tmp_path, "trainer-1", "--ray", nodes.address))
        with asking(endpoint) as asked:
            (long,) = asked.submit("BC-RNN", executor="ray", preset="fast")
            (short,) = asked.submit("BC", executor="ray")
            assert asked.wait_until_over(short.id).job.state == JOB_STATE_DONE
            before = asked.wait_for(long.id, lambda found: len(found.checkpoints) > 0).job
            assert before.state == JOB_STATE_RUNNING  # beside the other: there are two nodes
            with watched(worker_of(tmp_path / before.run)) as died:
                head: Any = nodes.head_node
                nodes.remove_node(head, allow_graceful=False)
                lost = asked.wait_for(long.id, lambda found: found.job.state == JOB_STATE_QUEUED)
                assert died()
            assert "Ray cluster" in lost.job.detail
        stack.enter_context(cluster(port, nodes=1))
        wait_for_another_checkpoint(RunDirectory(tmp_path / before.run))
        with asking(endpoint) as asked:
            again = asked.details(long.id).job
            assert (again.state, again.attempt) == (JOB_STATE_RUNNING, 1)
            asked.ask(cancel={"job": long.id})
            assert asked.details(long.id).job.state == JOB_STATE_CANCELLED


@pytest.mark.parametrize("address", ["", "head", "head:", ":6379", "ray://head:10001", "head:70000", "auto"])
def test_an_address_of_another_form_is_refused(address: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput):
        RayExecutor(address, tmp_path / "log", lambda _: None)
