"""Steps are run once, from the inputs that they have now; whatever goes wrong loses nothing."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from fcntl import LOCK_EX, flock
from pathlib import Path

import pytest

from mart.platform.reproduce.runner import Outcome, Runner
from mart.platform.reproduce.schedule import StepState
from mart.protocol.errors import Conflict, Unavailable
from mart.runtime.step_record import PlannedStep, read_records, write_record

COLLECT = PlannedStep(name="data", kind="collect", command=("collect",), result="data")
TRAIN = PlannedStep(
    name="run", kind="train", command=("train",), inputs=("data",), result="run", after=("data",)
)
OTHER = PlannedStep(
    name="other", kind="train", command=("other",), inputs=("data",), result="other", after=("data",)
)
JUDGE = PlannedStep(
    name="judged", kind="eval", command=("eval",), inputs=("run",), result="judged.json", after=("run",)
)
STEPS = (COLLECT, TRAIN, OTHER, JUDGE)


@dataclass
class WrittenStep:
    """A step that writes its result at once, or fails."""

    step: PlannedStep
    code: int
    ended: bool = True

    def stop(self) -> None:
        self.ended = True

    def finish(self) -> tuple[int, str]:
        return (self.code if self.ended else 130), "" if self.code == 0 else "it broke"


@dataclass
class Harness:
    """A folder and what was begun in it, in order."""

    folder: Path
    fails: set[str] = field(default_factory=set)
    hangs: set[str] = field(default_factory=set)
    begun: list[str] = field(default_factory=list)
    told: list[str] = field(default_factory=list)
    on_start: Callable[[str], object] = lambda _: None

    def start(self, folder: Path, step: PlannedStep, _jobs: int) -> WrittenStep:
        self.begun.append(step.name)
        place = folder / step.result
        if step.kind == "eval":
            place.write_text("results")
        else:
            place.mkdir(exist_ok=step.kind == "train")
            (place / ("a.mcap" if step.kind == "collect" else "run.json")).write_text(step.name)
        self.on_start(step.name)
        return WrittenStep(step, int(step.name in self.fails), ended=step.name not in self.hangs)

    def run(
        self, steps: tuple[PlannedStep, ...] = STEPS, free: int = 10**12, *, redo: bool = False
    ) -> Outcome:
        self.begun.clear()
        stop = threading.Event()
        if self.hangs:
            threading.Timer(0.5, stop.set).start()
        runner = Runner(
            self.folder, steps, self.told.append, redo=redo, start=self.start, free=lambda _: free
        )
        return runner.run(stop)


@pytest.fixture
def harness(tmp_path: Path) -> Harness:
    return Harness(tmp_path)


def test_all_is_done_once(harness: Harness) -> None:
    assert harness.run().complete
    assert harness.begun == ["data", "run", "other", "judged"]
    assert harness.run().complete
    assert harness.begun == []


def test_a_failed_step_is_told_and_the_others_go_on(harness: Harness) -> None:
    harness.fails = {"run"}
    outcome = harness.run()
    assert outcome.states == {
        "data": StepState.DONE, "run": StepState.FAILED, "other": StepState.DONE, "judged": StepState.TODO,
    }  # fmt: skip
    assert "it broke (see logs/run.log)" in outcome.why["run"]
    harness.fails = set()
    assert harness.run().complete
    assert harness.begun == ["run", "judged"]
    assert [attempt.exit_code for attempt in read_records(harness.folder)["run"].attempts] == [1, 0]


def test_changed_inputs_are_said_and_nothing_of_them_is_used(harness: Harness) -> None:
    harness.run()
    (harness.folder / "data" / "a.mcap").write_text("edited since")
    outcome = harness.run()
    assert harness.begun == []
    assert outcome.states["run"] is StepState.CHANGED
    assert outcome.why["run"] == "data is not what it was made from"
    assert outcome.states["judged"] is not StepState.DONE
    assert any("was changed since it was made" in line for line in harness.told)


def test_what_was_made_from_something_else_is_made_anew_where_that_is_asked_for(harness: Harness) -> None:
    harness.run()
    (harness.folder / "data" / "a.mcap").write_text("edited since")
    assert harness.run(redo=True).complete
    assert harness.begun[:2] == ["run", "other"]
    kept = list((harness.folder / "set-aside").glob("run-*/run.json"))
    assert [path.read_text() for path in kept] == ["run"]


def test_another_command_is_another_step(harness: Harness) -> None:
    harness.run()
    changed = TRAIN.model_copy(update={"command": ("train", "--preset", "paper")})
    outcome = harness.run((COLLECT, changed))
    assert outcome.why["run"] == "its command was `mart train`"
    assert harness.begun == []


def test_a_killed_collection_is_kept_aside_and_made_again(harness: Harness) -> None:
    harness.run()
    record = read_records(harness.folder)["data"]
    write_record(harness.folder, record.model_copy(update={"status": "running", "result": ""}))
    harness.run((COLLECT,))
    assert harness.begun == ["data"]
    assert len(list((harness.folder / "set-aside").glob("data-*/a.mcap"))) == 1


def test_a_result_that_is_gone_is_made_again(harness: Harness) -> None:
    harness.run()
    (harness.folder / "judged.json").unlink()
    assert harness.run().complete
    assert harness.begun == ["judged"]


def test_a_full_disk_stops_before_anything_is_begun(harness: Harness) -> None:
    with pytest.raises(Unavailable, match=r"0\.1 GB left"):
        harness.run(free=10**8)
    assert harness.begun == []
    assert harness.run().complete


def test_a_step_that_broke_on_a_full_disk_did_not_fail(harness: Harness) -> None:
    harness.fails = {"data"}
    spaces = iter([10**12, 0])
    runner = Runner(
        harness.folder, STEPS, harness.told.append, start=harness.start, free=lambda _: next(spaces, 0)
    )
    with pytest.raises(Unavailable, match="Nothing is lost"):
        runner.run(threading.Event())
    assert read_records(harness.folder)["data"].status == "interrupted"


def test_a_stop_ends_what_runs_and_says_so(harness: Harness) -> None:
    harness.hangs = {"run"}
    outcome = harness.run()
    assert outcome.stopped
    assert read_records(harness.folder)["run"].status in ("interrupted", "done")
    harness.hangs = set()
    assert harness.run().complete


def test_two_do_not_work_in_one_folder(harness: Harness) -> None:
    with (harness.folder / "reproduce.lock").open("ab") as lock:
        flock(lock, LOCK_EX)
        with pytest.raises(Conflict, match="Another"):
            harness.run()


def test_results_of_other_versions_are_used_and_said(harness: Harness) -> None:
    harness.run()
    record = read_records(harness.folder)["run"]
    older = {**record.versions, "mart-trainer": "0.1.0"}
    write_record(harness.folder, record.model_copy(update={"versions": older}))
    assert harness.run().complete
    assert harness.begun == []
    assert any("it was made with mart-trainer 0.1.0" in line for line in harness.told)
    assert "0.1.0" in read_records(harness.folder)["run"].note
