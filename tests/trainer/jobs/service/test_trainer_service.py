"""The trainer service as a process: jobs over a real bus, through cancellations, crashes and kills."""

from __future__ import annotations

import json
import os
import select
import shutil
import signal
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from mart.episodes import labels
from mart.protocol import clock, codec, keys
from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.messages import (
    JOB_STATE_CANCELLED,
    JOB_STATE_DONE,
    JOB_STATE_FAILED,
    JOB_STATE_QUEUED,
    JOB_STATE_RUNNING,
    Job,
    Order,
    TrainerReply,
    TrainerRequest,
    raise_error,
)
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.trainer.jobs.service.cli import show, submit, wait
from tests.support.processes import Running, running_router, running_service, started
from tests.trainer.conftest import Recorded
from tests.trainer.recorded import TASK

# Every job begins with importing torch, which takes its time on a busy machine.
pytestmark = [pytest.mark.system, pytest.mark.timeout(300)]

_WAIT_S = 120.0
_BETWEEN_S = 0.1


class Client:
    """Asks the trainer, as the pages do."""

    def __init__(self, bus: ZenohBus, trainer: str) -> None:
        self._bus = bus
        self._topic = keys.training(trainer)

    def ask(self, **what: Any) -> TrainerReply:
        request = codec.encode(TrainerRequest(**what))
        reply = codec.decode(TrainerReply, self._bus.query(self._topic, request, 10.0))
        raise_error(reply.error)
        return reply

    def submit(self, *models: str, executor: str = "", episodes: int = 0, **order: Any) -> list[Job]:
        fields: dict[str, Any] = {"preset": "debug", "data": "episodes", "score_episodes": 0, **order}
        submit = TrainerRequest.Submit(
            models=models,
            tasks=[TASK],
            order=Order(evaluation_episodes=episodes, **fields),
            executor=executor,
        )
        return list(self.ask(submit=submit).jobs)

    def details(self, job: str) -> TrainerReply.Details:
        return self.ask(show=TrainerRequest.Show(job=job)).details

    def wait_for(self, job: str, holds: Callable[[TrainerReply.Details], bool]) -> TrainerReply.Details:
        """Asks again and again, for the trainer tells nothing by itself."""
        deadline_s = clock.monotonic_s() + _WAIT_S
        while not holds(details := self.details(job)):
            assert clock.monotonic_s() < deadline_s, f"{details.job}\n{self.log(job)}"
            clock.sleep_s(_BETWEEN_S)
        return details

    def wait_until_over(self, job: str) -> TrainerReply.Details:
        over = (JOB_STATE_DONE, JOB_STATE_FAILED, JOB_STATE_CANCELLED)
        return self.wait_for(job, lambda details: details.job.state in over)

    def log(self, job: str) -> str:
        return self.ask(logs=TrainerRequest.Logs(job=job)).log.decode()


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    with running_router() as endpoint:
        yield endpoint


@pytest.fixture(scope="module")
def client(endpoint: str) -> Iterator[Client]:
    with ZenohBus.connect(endpoint) as bus:
        yield Client(bus, "trainer-1")


@pytest.fixture(scope="module")
def data_dir(episodes: Recorded, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("trainer")
    (folder / "episodes").symlink_to(episodes.root)
    return folder


def trainer(endpoint: str, data_dir: Path, name: str, *options: str) -> AbstractContextManager[Running]:
    command = ["trainer", "--name", name, *options]
    return running_service(command, endpoint, data_dir, kind="trainer", id=name)


@pytest.fixture(scope="module")
def service(endpoint: str, data_dir: Path) -> Iterator[Running]:
    with trainer(endpoint, data_dir, "trainer-1") as running:
        yield running


@pytest.mark.usefixtures("service")
def test_a_sweep_is_one_submission(client: Client, endpoint: str, monkeypatch: pytest.MonkeyPatch) -> None:
    choices = client.ask(choices=TrainerRequest.Choices()).choices
    assert [data.episodes for data in choices.data if data.path == "episodes"] == [3]
    assert {"r-HBC", "BC-RNN"} <= {model.name for model in choices.models}
    first, second = client.submit("d-BC", "BC", seeds=[0, 3])[::-1]
    assert (first.sweep, [first.order.model, second.order.model]) == (second.sweep, ["d-BC", "BC"])
    details = client.wait_until_over(first.id)
    assert details.job.state == JOB_STATE_DONE, client.log(first.id)
    assert (details.job.progress.updates, details.job.progress.updates_in_all) == (20, 20)
    (loss,) = [curve for curve in details.curves if curve.name == "loss"]
    assert list(loss.updates) == sorted(loss.updates)
    assert len(loss.values) == len(loss.updates) > 0
    assert len(details.checkpoints) == 4
    newer = client.ask(show=TrainerRequest.Show(job=first.id, since_updates=19)).details
    assert {tuple(curve.updates) for curve in newer.curves} == {(20,)}
    client.ask(cancel=TrainerRequest.Cancel(job=first.sweep))
    assert client.details(second.id).job.state == JOB_STATE_CANCELLED
    with pytest.raises(Conflict):
        client.ask(cancel=TrainerRequest.Cancel(job=first.sweep))
    monkeypatch.setenv("MART_ROUTER", endpoint)
    waited = CliRunner().invoke(wait, [first.sweep])
    assert (waited.exit_code, "cancelled" in waited.output) == (1, True)


@pytest.mark.usefixtures("service")
def test_from_a_judged_job_to_a_policy(client: Client, data_dir: Path) -> None:
    (job,) = client.submit("d-BC", episodes=1, score_episodes=1)
    details = client.wait_until_over(job.id)
    assert details.job.state == JOB_STATE_DONE, client.log(job.id)
    assert details.job.progress.best_success == 0.0
    judged = [(found.purpose, found.updates, found.episodes) for found in details.evaluations]
    assert judged == [("selection", 10, 1), ("selection", 20, 1), ("score", 20, 1)]
    assert details.evaluations[-1].rollouts
    (policy,) = client.ask(promote=TrainerRequest.Promote(job=job.id, name="lifter")).policies
    assert (policy.model, policy.task, policy.joint, policy.updates) == ("d-BC", TASK, False, 20)
    assert policy.evaluation.purpose == "score"
    files = sorted(path.name for path in (data_dir / "policies" / "lifter").iterdir())
    assert files == ["checkpoint.json", "policy.json", "weights.safetensors"]
    with pytest.raises(Conflict):
        client.ask(promote=TrainerRequest.Promote(job=job.id, name="lifter"))
    assert list(client.ask(policies=TrainerRequest.Policies(task=TASK)).policies) == [policy]
    assert not client.ask(policies=TrainerRequest.Policies(task="another")).policies
    client.ask(withdraw=TrainerRequest.Withdraw(policy="lifter"))
    assert not client.ask(policies=TrainerRequest.Policies()).policies


@pytest.mark.usefixtures("service")
def test_a_job_learns_from_the_data_set_as_it_was_ordered(
    client: Client, data_dir: Path, endpoint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = data_dir / "sorted"
    shutil.copytree(data_dir / "episodes", folder)
    first, second, third = sorted(folder.rglob("*.mcap"))
    for path in (first, second):
        labels.say(path, labels.LabelKind.JOIN, "few", 1)
    labels.say(first, labels.LabelKind.USE, "drop", 2)
    monkeypatch.setenv("MART_ROUTER", endpoint)
    words = ["--models", "BC", "--tasks", TASK, "--data", "sorted", "--dataset", "few", "--preset", "debug"]
    ordered = CliRunner().invoke(submit, [*words, "--episodes", "0", "--json"])
    assert ordered.exit_code == 0, ordered.output
    (job,) = json.loads(ordered.output)["jobs"]
    assert (job["order"]["dataset"], job["order"]["data"]) == ("few", str(folder))
    labels.say(third, labels.LabelKind.JOIN, "few", 3)
    details = client.wait_until_over(job["id"])
    assert details.job.state == JOB_STATE_DONE, client.log(job["id"])
    learned = details.learned
    assert (learned.dataset, learned.dataset_episodes, learned.episodes) == ("few", 2, 1)
    assert list(learned.left_out) == [f"{first.name} (dropped)"]
    assert f"{first.name} (dropped)" in client.log(job["id"])
    shown = CliRunner().invoke(show, [job["id"]])
    assert "Episodes learned from: 1 of the 2 in few;" in shown.output
    with pytest.raises(NotFound):
        client.submit("BC", data="sorted", dataset="fwe")
    other = TrainerRequest.Submit(
        models=["BC"], tasks=["two_arm_drink_tray_lifting"], order=Order(data="sorted", dataset="few")
    )
    with pytest.raises(InvalidInput):
        client.ask(submit=other)


@pytest.mark.usefixtures("service")
def test_what_cannot_be_ordered_is_said_at_once(client: Client) -> None:
    order: dict[str, Any]
    for error, words, order in (
        (NotFound, "Did you mean 'r-hbc'|Did you mean 'r-HBC'", {"model": "rHBC"}),
        (NotFound, "no episodes of", {"data": "nowhere"}),
        (NotFound, "no preset 'quick'", {"preset": "quick"}),
        (NotFound, "no executor 'slurm'", {"executor": "slurm"}),
        (InvalidInput, "seeds must differ", {"seeds": [1, 1]}),
        (InvalidInput, "1025 bytes", {"data": "x" * 1025}),
        (InvalidInput, "5000 episodes", {"episodes": 5000}),
    ):
        model = str(order.pop("model", "BC"))
        with pytest.raises(error, match=words):
            client.submit(model, **order)
    with pytest.raises(NotFound):
        client.details("job-9999")
    with pytest.raises(NotFound):
        client.details("seven")
    with pytest.raises(NotFound):
        client.ask(cancel=TrainerRequest.Cancel(job="sweep-0999"))
    with pytest.raises(InvalidInput):
        client.submit()
    with pytest.raises(InvalidInput):
        client.ask()


@pytest.mark.usefixtures("service")
def test_a_job_whose_data_is_damaged_fails_with_a_sentence(client: Client, data_dir: Path) -> None:
    (data_dir / "bad").mkdir()
    (data_dir / "bad" / f"room-1-0001-{TASK}.mcap").write_bytes(b"no episode")
    (job,) = client.submit("BC", data="bad")
    details = client.wait_until_over(job.id)
    assert details.job.state == JOB_STATE_FAILED
    assert details.job.attempt == 1
    assert "is no MCAP file" in details.job.detail
    assert "Traceback" not in client.log(job.id)


def test_a_killed_trainer_takes_its_jobs_along_and_the_next_one_goes_on(
    endpoint: str, episodes: Recorded, tmp_path: Path
) -> None:
    (tmp_path / "episodes").symlink_to(episodes.root)
    with ZenohBus.connect(endpoint) as bus:
        client = Client(bus, "trainer-2")
        with trainer(endpoint, tmp_path, "trainer-2") as running:
            (job,) = client.submit("BC", preset="fast")
            details = client.wait_for(job.id, lambda details: len(details.checkpoints) > 0)
            run = tmp_path / details.job.run
            with watched(worker_of(run)) as died:
                running.kill()
                assert died()
        with trainer(endpoint, tmp_path, "trainer-2"):
            again = client.wait_for(job.id, lambda now: len(now.checkpoints) > len(details.checkpoints))
            assert (again.job.state, again.job.attempt) == (JOB_STATE_RUNNING, 1)
            updates = next(list(curve.updates) for curve in again.curves if curve.name == "loss")
            assert updates == sorted(set(updates))  # what was lost was made again, once
            os.kill(worker_of(run), signal.SIGKILL)
            again = client.wait_for(job.id, lambda now: now.job.attempt == 2)
            assert again.job.state == JOB_STATE_RUNNING
            client.ask(cancel=TrainerRequest.Cancel(job=job.id))
            (again_queued,) = client.ask(retry=TrainerRequest.Retry(job=job.id)).jobs
            assert again_queued.state == JOB_STATE_QUEUED
            client.wait_for(job.id, lambda now: now.job.state == JOB_STATE_RUNNING)
            client.ask(cancel=TrainerRequest.Cancel(job=job.id))


def test_two_trainers_do_not_share_a_queue(endpoint: str, data_dir: Path, service: Running) -> None:
    with started(["trainer", "--name", "trainer-3"], endpoint, data_dir) as second:
        assert second.process.wait(30) == 1
        assert "another trainer" in second.log()
    assert service.process.poll() is None


def worker_of(run: Path) -> int:
    """The process that trains a run: its command line ends with the run's folder."""
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
        except (FileNotFoundError, ProcessLookupError):
            continue
        if words[-2:-1] == [str(run.resolve()).encode()]:
            return int(process.name)
    raise AssertionError(f"nobody trains {run}")


@contextmanager
def watched(process: int) -> Iterator[Callable[[], bool]]:
    """Tells whether a process that lives now has died, or does so soon."""
    descriptor = os.pidfd_open(process)
    try:
        yield lambda: bool(select.select([descriptor], [], [], _WAIT_S)[0])
    finally:
        os.close(descriptor)
