"""What could not be verified is tried again: later each time, at once when a replica appears, and never forgotten."""

from __future__ import annotations

from pathlib import Path

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from mart.recorder.verify.retry_schedule import FIRST_DELAY_S, LONGEST_DELAY_S, RetrySchedule

_MOST = 3
_FILES = st.sampled_from([Path(name) for name in "abcde"])


class Schedules(RuleBasedStateMachine):
    """Some files come, are tried and put off, or get their verdict, while time goes on."""

    def __init__(self) -> None:
        super().__init__()
        self.schedule, self.now_s = RetrySchedule(_MOST), 0.0
        self.due: dict[Path, float] = {}

    @rule(seconds=st.floats(0.0, 2 * LONGEST_DELAY_S))
    def wait(self, seconds: float) -> None:
        self.now_s += seconds

    @rule(path=_FILES)
    def add(self, path: Path) -> None:
        self.schedule.add(path, self.now_s)
        if path not in self.due and len(self.due) < _MOST:
            self.due[path] = self.now_s
        elif path not in self.due:
            assert self.schedule.is_short

    @rule()
    def put_off(self) -> None:
        path = self.schedule.next_due(self.now_s)
        if path is not None:
            self.schedule.put_off(path, self.now_s)
            due_s = self.schedule.due_s()
            assert due_s is not None
            self.due[path] = self.now_s + FIRST_DELAY_S  # at least

    @rule(path=_FILES)
    def drop(self, path: Path) -> None:
        self.schedule.drop(path)
        self.due.pop(path, None)

    @rule()
    def wake(self) -> None:
        self.schedule.wake(self.now_s)
        self.due = {path: min(due_s, self.now_s) for path, due_s in self.due.items()}

    @invariant()
    def holds(self) -> None:
        assert len(self.schedule) == len(self.due) <= _MOST
        path = self.schedule.next_due(self.now_s)
        assert path is None or self.due[path] <= self.now_s
        if self.due:
            assert self.schedule.next_due(self.now_s + LONGEST_DELAY_S) is not None


TestSchedules = Schedules.TestCase


def test_it_waits_twice_as_long_each_time_and_ten_minutes_at_most() -> None:
    schedule, path, now_s, delays = RetrySchedule(), Path("a"), 0.0, []
    schedule.add(path, now_s)
    for _ in range(12):
        schedule.put_off(path, now_s)
        due_s = schedule.due_s()
        assert due_s is not None
        delays.append(due_s - now_s)
        now_s = due_s
    assert delays[:4] == [2.0, 4.0, 8.0, 16.0]
    assert delays[-1] == LONGEST_DELAY_S
    schedule.wake(now_s - 1.0)
    assert schedule.next_due(now_s - 1.0) == path
