"""The queue and its table: whatever happens, no job is lost and none runs twice."""

from __future__ import annotations

import contextlib
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from mart.protocol.errors import Conflict, Corrupt, NotFound
from mart.trainer.evaluate.config import EvaluationSpec
from mart.trainer.jobs.executors.executor import JobEnded
from mart.trainer.jobs.job import MAX_ATTEMPTS, ExitCode, JobSpec, JobState
from mart.trainer.jobs.queue import MAX_WAITING, JobQueue
from mart.trainer.jobs.table import JobTable
from mart.trainer.train.spec import TrainingSpec

SPEC = JobSpec(
    training=TrainingSpec(model="HBC", data=(Path("/episodes"),)), evaluation=EvaluationSpec(task="t")
)
CODES = st.sampled_from([*ExitCode, -9, 2])


class Slots:
    """An executor whose jobs end when the test says so."""

    def __init__(self, slots: int) -> None:
        self.slots = slots
        self.trouble = "" if slots else "nobody is there"
        self.running: list[int] = []
        self.stopped: list[int] = []

    def start(self, job: int, run: Path) -> None:
        assert (run / "job.json").is_file()
        assert job not in self.running
        self.running.append(job)

    def stop(self, job: int) -> None:
        self.stopped.append(job)

    def close(self) -> None:
        self.running.clear()


@pytest.fixture
def table(tmp_path: Path) -> Iterator[JobTable]:
    with contextlib.closing(JobTable(tmp_path / "jobs.sqlite")) as table:
        yield table


def test_jobs_come_back_as_they_were_put(table: JobTable, tmp_path: Path) -> None:
    queue = JobQueue(table, {"local": Slots(1)}, tmp_path, now_ns=0)
    jobs = queue.submit([SPEC, SPEC], "local", now_ns=5)
    assert [job.id for job in jobs] == ["job-0001", "job-0002"]
    with contextlib.closing(JobTable(tmp_path / "jobs.sqlite")) as again:
        assert again.newest(10) == jobs[::-1]
        assert again.newest(10, sweep=2) == []
    (third,) = queue.submit([SPEC], "local", now_ns=6)
    assert (third.number, third.sweep) == (3, 2)


def test_the_oldest_run_first_and_no_more_than_there_is_room_for(table: JobTable, tmp_path: Path) -> None:
    slots = Slots(2)
    queue = JobQueue(table, {"local": slots}, tmp_path, now_ns=0)
    queue.submit([SPEC] * 4, "local", now_ns=0)
    queue.advance(now_ns=1)
    assert slots.running == [1, 2]
    slots.running.remove(2)
    queue.end(JobEnded(2, ExitCode.DONE), now_ns=2)
    queue.advance(now_ns=3)
    assert slots.running == [1, 3]


def test_a_crash_is_tried_again_three_times_and_a_refusal_never(table: JobTable, tmp_path: Path) -> None:
    slots = Slots(1)
    queue = JobQueue(table, {"local": slots}, tmp_path, now_ns=0)
    queue.submit([SPEC, SPEC], "local", now_ns=0)
    for _ in range(MAX_ATTEMPTS):
        queue.advance(now_ns=1)
        assert slots.running.pop() == 1
        queue.end(JobEnded(1, -9, "its process was killed (SIGKILL)"), now_ns=2)
    assert (table.get(1).state, table.get(1).detail) == (JobState.FAILED, "its process was killed (SIGKILL)")
    queue.advance(now_ns=3)
    queue.end(JobEnded(2, ExitCode.REFUSED, "There are no episodes."), now_ns=4)
    assert (table.get(2).state, table.get(2).attempt) == (JobState.FAILED, 1)


def test_a_job_that_is_still_stopping_waits_for_its_own_end(table: JobTable, tmp_path: Path) -> None:
    slots = Slots(1)
    queue = JobQueue(table, {"local": slots}, tmp_path, now_ns=0)
    queue.submit([SPEC], "local", now_ns=0)
    queue.advance(now_ns=1)
    queue.retry(*queue.cancel([table.get(1)], now_ns=2))
    queue.advance(now_ns=3)
    assert (slots.running, slots.stopped) == ([1], [1])
    slots.running.clear()
    queue.end(JobEnded(1, ExitCode.STOPPED), now_ns=4)
    queue.advance(now_ns=5)
    assert slots.running == [1]


def test_a_lost_cluster_costs_no_attempt(table: JobTable, tmp_path: Path) -> None:
    slots = Slots(1)
    queue = JobQueue(table, {"ray": slots}, tmp_path, now_ns=0)
    queue.submit([SPEC], "ray", now_ns=0)
    now_ns = 0
    for _ in range(5 * MAX_ATTEMPTS):
        now_ns = table.get(1).retry_ns
        queue.advance(now_ns)
        queue.end(JobEnded(slots.running.pop(), ExitCode.LOST, "waits for the cluster"), now_ns)
    assert (table.get(1).state, table.get(1).attempt) == (JobState.QUEUED, 0)


def setbacks(queue: JobQueue, table: JobTable, slots: Slots, code: ExitCode, worked_s: int = 1) -> list[int]:
    """Let job 1 meet one setback after the other, at once when it may; return the seconds that it waited each time."""
    now_ns, waited = 0, list[int]()
    while table.get(1).state is JobState.QUEUED and len(waited) < 50:
        queue.advance(now_ns)
        if not slots.running:  # not yet
            assert table.get(1).retry_ns > now_ns
            waited.append((table.get(1).retry_ns - now_ns) // 10**9)
            now_ns = table.get(1).retry_ns
            queue.advance(now_ns)
        slots.running.clear()
        now_ns += worked_s * 10**9
        queue.end(JobEnded(1, code, "no replica is up"), now_ns)
    return waited


@pytest.mark.parametrize("code", [ExitCode.AWAY, ExitCode.LOST])
def test_setbacks_are_waited_out_longer_each_time_and_end_somewhere(
    table: JobTable, tmp_path: Path, code: ExitCode
) -> None:
    slots = Slots(1)
    queue = JobQueue(table, {"local": slots}, tmp_path, now_ns=0)
    queue.submit([SPEC], "local", now_ns=0)
    waited = setbacks(queue, table, slots, code)
    assert waited[:4] == [10, 20, 40, 80]
    assert waited[-1] == 600
    assert sum(waited) > 2 * 3600
    assert (table.get(1).state, table.get(1).attempt) == (JobState.FAILED, 1)
    assert "no replica is up" in table.get(1).detail
    queue.retry(table.get(1))
    queue.advance(now_ns=1)
    assert slots.running == [1]


def test_a_job_that_worked_in_between_may_be_interrupted_for_ever(table: JobTable, tmp_path: Path) -> None:
    slots = Slots(1)
    queue = JobQueue(table, {"local": slots}, tmp_path, now_ns=0)
    queue.submit([SPEC], "local", now_ns=0)
    setbacks(queue, table, slots, ExitCode.AWAY, worked_s=3600)
    assert table.get(1).state is JobState.QUEUED


def test_what_waits_is_looked_through_without_reading_what_it_trains_on(
    table: JobTable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    queue = JobQueue(table, {"local": Slots(0)}, tmp_path, now_ns=0)
    queue.submit([SPEC] * 3, "local", now_ns=0)

    def reading(*_: object, **__: object) -> TrainingSpec:
        pytest.fail("A spec was read.")

    monkeypatch.setattr(TrainingSpec, "model_validate_json", reading)
    queue.advance(now_ns=1)
    assert [job.detail for job in table.queued()] == ["nobody is there"] * 3


def test_a_table_of_the_version_before_is_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "jobs.sqlite"
    with contextlib.closing(JobTable(path)) as table:
        jobs = JobQueue(table, {"local": Slots(1)}, tmp_path, now_ns=0).submit([SPEC], "local", now_ns=5)
    with contextlib.closing(sqlite3.connect(path)) as older:
        older.executescript(
            "ALTER TABLE jobs DROP COLUMN setbacks; ALTER TABLE jobs DROP COLUMN retry_ns; PRAGMA user_version = 1;"
        )
    with contextlib.closing(JobTable(path)) as table:
        assert table.newest(10) == jobs


def test_a_job_that_waits_says_for_what(table: JobTable, tmp_path: Path) -> None:
    queue = JobQueue(table, {"ray": Slots(0)}, tmp_path, now_ns=0)
    queue.submit([SPEC], "ray", now_ns=0)
    queue.advance(now_ns=1)
    assert table.get(1).detail == "nobody is there"


def test_what_ran_when_the_trainer_died_is_queued_again(table: JobTable, tmp_path: Path) -> None:
    JobQueue(table, {"local": (first := Slots(1))}, tmp_path, now_ns=0).submit([SPEC], "local", now_ns=0)
    JobQueue(table, {"local": first}, tmp_path, now_ns=0).advance(now_ns=1)
    assert table.get(1).state is JobState.RUNNING
    second = Slots(1)
    JobQueue(table, {"local": second}, tmp_path, now_ns=0).advance(now_ns=2)
    assert second.running == [1]
    assert table.get(1).attempt == 1


def test_what_cannot_be_is_said(table: JobTable, tmp_path: Path) -> None:
    queue = JobQueue(table, {"local": Slots(0)}, tmp_path, now_ns=0)
    with pytest.raises(NotFound):
        queue.submit([SPEC], "locl", now_ns=0)
    with pytest.raises(NotFound):
        table.get(9)
    with pytest.raises(Conflict):
        queue.submit([SPEC] * (MAX_WAITING + 1), "local", now_ns=0)
    (job,) = queue.submit([SPEC], "local", now_ns=0)
    with pytest.raises(Conflict):
        queue.retry(job)
    (cancelled,) = queue.cancel([job], now_ns=1)
    with pytest.raises(Conflict):
        queue.cancel([cancelled], now_ns=2)
    assert queue.retry(cancelled).state is JobState.QUEUED


def test_a_file_that_is_no_job_table_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("no table " * 100)
    with contextlib.closing(sqlite3.connect(tmp_path / "newer")) as newer:
        newer.execute("PRAGMA user_version = 99")
    for path in (tmp_path / "text", tmp_path / "newer"):
        with pytest.raises(Corrupt) as caught:
            JobTable(path)
        assert str(path) in str(caught.value)
        opened = [link.resolve() for link in Path("/proc/self/fd").iterdir() if link.exists()]
        assert path not in opened  # Python 3.13 warns of a connection that nobody closed


class QueueMachine(RuleBasedStateMachine):
    """Submissions, ends, cancellations, retries and deaths of the trainer, in any order."""

    folder: Path

    def __init__(self) -> None:
        super().__init__()
        self.table = JobTable(Path(":memory:"))
        self.slots = Slots(2)
        self.queue = JobQueue(self.table, {"local": self.slots}, self.folder, now_ns=0)
        self.submitted = 0

    def teardown(self) -> None:
        self.table.close()

    @rule(number=st.integers(1, 3))
    def submit(self, number: int) -> None:
        self.queue.submit([SPEC] * number, "local", now_ns=0)
        self.submitted += number

    @rule()
    def advance(self) -> None:
        self.queue.advance(now_ns=1)

    @precondition(lambda self: self.slots.running)
    @rule(data=st.data(), code=CODES)
    def end(self, data: st.DataObject, code: int) -> None:
        job = data.draw(st.sampled_from(self.slots.running))
        self.slots.running.remove(job)
        self.queue.end(JobEnded(job, code, "why"), now_ns=2)

    @precondition(lambda self: self.submitted)
    @rule(data=st.data())
    def cancel(self, data: st.DataObject) -> None:
        job = self.table.get(data.draw(st.integers(1, self.submitted)))
        with contextlib.suppress(Conflict):
            self.queue.cancel([job], now_ns=3)

    @precondition(lambda self: self.submitted)
    @rule(data=st.data())
    def retry(self, data: st.DataObject) -> None:
        job = self.table.get(data.draw(st.integers(1, self.submitted)))
        with contextlib.suppress(Conflict):
            self.queue.retry(job)

    @rule()
    def die(self) -> None:
        self.slots.close()
        self.queue = JobQueue(self.table, {"local": self.slots}, self.folder, now_ns=0)

    @invariant()
    def nothing_is_lost(self) -> None:
        jobs = self.table.newest(10_000)
        assert len(jobs) == self.submitted
        running = {job.number for job in jobs if job.state is JobState.RUNNING}
        assert running <= set(self.slots.running)
        assert len(running) <= self.slots.slots
        assert all(0 <= job.attempt <= MAX_ATTEMPTS for job in jobs)


@pytest.fixture(autouse=True, scope="module")
def _folder(tmp_path_factory: pytest.TempPathFactory) -> None:
    QueueMachine.folder = tmp_path_factory.mktemp("runs")


TestQueueMachine = QueueMachine.TestCase
TestQueueMachine.settings = settings(max_examples=30, stateful_step_count=30, deadline=None)
