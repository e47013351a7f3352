"""How long it will take, as far as anything tells."""

from __future__ import annotations

from mart.platform.reproduce.schedule import Remaining, StepState, duration, ready, remaining
from mart.runtime.step_record import PlannedStep, StepAttempt, StepRecord


def step(name: str, kind: str = "train", task: str = "cubes") -> PlannedStep:
    return PlannedStep.model_validate(
        {"name": name, "kind": kind, "command": (kind,), "result": name, "task": task}
    )


def done(planned: PlannedStep, wall_s: float) -> StepRecord:
    attempt = StepAttempt(began_ns=0, ended_ns=round(wall_s * 1e9), exit_code=0)
    return StepRecord(step=planned, status="done", inputs={}, attempts=(attempt,))


def test_an_estimate_is_of_the_nearest_of_its_kind_and_counts_what_it_cannot_know() -> None:
    steps = [step("a"), step("b"), step("c", task="tray"), step("judge", "eval")]
    states = dict.fromkeys("abc", StepState.TODO) | {"judge": StepState.TODO, "a": StepState.DONE}
    found = remaining(steps, states, {"a": done(steps[0], 60.0)}, jobs=2)
    assert found == Remaining(steps=3, wall_s=60.0, unknown=1)
    assert found.in_words() == "3 left: about 60 s and 1 of a kind that has not run yet"
    assert "not known" in remaining(steps, states, {}, jobs=1).in_words()


def test_nothing_begins_beside_a_collection() -> None:
    steps = [step("collected", "collect"), step("trained")]
    states = dict.fromkeys(("collected", "trained"), StepState.TODO)
    assert [one.name for one in ready(steps, states, {"collected"})] == []
    assert [one.name for one in ready(steps, states, {"trained"})] == []
    assert [one.name for one in ready(steps, states, ())] == ["collected", "trained"]


def test_times_are_said_as_people_say_them() -> None:
    assert [duration(s) for s in (3, 89, 600, 7200)] == ["3 s", "89 s", "10 min", "2.0 h"]
