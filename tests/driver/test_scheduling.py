"""A driver asks to go first, and says in a sentence where it may not."""

from __future__ import annotations

import os

import pytest

from mart.driver.scheduling import go_first


def test_it_asks_for_real_time_scheduling_of_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, int, int]] = []
    monkeypatch.setattr(
        os, "sched_setscheduler", lambda pid, policy, how: asked.append((pid, policy, how.sched_priority))
    )
    assert go_first() == ""
    assert asked == [(0, os.SCHED_RR, 10)]


def test_where_it_may_not_it_says_so_and_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refused)
    assert go_first().startswith("Real-time scheduling was refused (Operation not permitted): a busy machine")
    monkeypatch.delattr(os, "sched_setscheduler")
    assert go_first().startswith("This system has no real-time scheduling")
