"""A process that stands still ends; one that was frozen with its watchdog does not."""

from __future__ import annotations

import threading

from mart.runtime.watchdog import Watchdog, start_vital_thread

_PATIENCE_S = 10.0


def test_so_many_looks_in_a_row_without_food_and_it_is_time() -> None:
    watchdog = Watchdog("The room", most_misses=3)
    assert [watchdog.look() for _ in range(3)] == [False, False, False]  # the first sees it begin
    watchdog.feed()
    assert [watchdog.look() for _ in range(4)] == [False, False, False, True]


def test_it_says_what_stood_still() -> None:
    ended, said = threading.Event(), list[str]()

    def end(why: str) -> None:
        said.append(why)
        ended.set()

    with Watchdog("The room", most_misses=2, look_every_s=0.01, end=end):
        assert ended.wait(_PATIENCE_S)
    assert said == ["The room has done nothing for 0.02 s"]


def test_a_vital_thread_that_fails_ends_the_process() -> None:
    said = list[str]()

    def fail() -> None:
        raise ValueError

    start_vital_thread(fail, "saves", said.append).join(_PATIENCE_S)
    start_vital_thread(lambda: None, "saves", said.append).join(_PATIENCE_S)
    assert said == ["its thread saves failed (ValueError)"]
