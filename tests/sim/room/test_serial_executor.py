"""Whose turn it is: one thread at a time, nothing is forgotten, what is due is done."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from mart.protocol import clock
from mart.sim.room.serial_executor import SerialExecutor

FAR_S = 3600.0
PATIENCE_S = 10.0


@contextmanager
def running(executor: SerialExecutor) -> Iterator[None]:
    stop = threading.Event()
    runner = threading.Thread(target=executor.run, args=(stop,))
    runner.start()
    try:
        yield
    finally:
        stop.set()
        executor.submit(lambda: None)
        runner.join(PATIENCE_S)
        assert not runner.is_alive()


def test_the_thread_that_brings_work_does_it_and_what_follows() -> None:
    done_by = list[int]()

    def advance(now_s: float) -> float:
        done_by.append(threading.get_ident())
        return now_s + FAR_S

    SerialExecutor(advance).submit(lambda: done_by.append(threading.get_ident()))
    assert done_by == [threading.get_ident()] * 2


def test_work_that_comes_in_another_turn_is_done_by_its_holder() -> None:
    """And whoever brings it does not wait."""
    entered, leave, order = threading.Event(), threading.Event(), list[str]()
    executor = SerialExecutor(lambda now_s: now_s + FAR_S)

    def long_work() -> None:
        entered.set()
        assert leave.wait(PATIENCE_S)
        order.append("first")

    holder = threading.Thread(target=executor.submit, args=(long_work,))
    holder.start()
    assert entered.wait(PATIENCE_S)
    executor.submit(lambda: order.append("second"))
    assert order == []
    leave.set()
    holder.join(PATIENCE_S)
    assert order == ["first", "second"]


def test_no_two_threads_have_a_turn_and_no_work_is_lost() -> None:
    inside, together, done = list[int](), list[int](), list[int]()
    executor = SerialExecutor(lambda now_s: now_s + FAR_S)

    def work() -> None:
        inside.append(1)
        together.append(len(inside))
        done.append(1)
        inside.pop()

    def bring() -> None:
        for _ in range(500):
            executor.submit(work)

    with running(executor):
        threads = [threading.Thread(target=bring) for _ in range(2)]  # 1000 wait at most: none is refused
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(PATIENCE_S)
    assert len(done) == 1000
    assert set(together) == {1}


def test_work_that_is_left_is_done_by_the_run() -> None:
    done_by, done = list[str](), threading.Event()

    def work() -> None:
        done_by.append(threading.current_thread().name)
        done.set()

    executor = SerialExecutor(lambda now_s: now_s + FAR_S)
    with running(executor):
        executor.leave(work)
        assert done.wait(PATIENCE_S)
    assert done_by != [threading.current_thread().name]


def test_whoever_waits_for_a_turn_sleeps() -> None:
    """However overdue the room is."""
    entered, leave = threading.Event(), threading.Event()
    executor = SerialExecutor(lambda now_s: 0.0)

    def long_work() -> None:
        entered.set()
        assert leave.wait(PATIENCE_S)

    holder = threading.Thread(target=executor.submit, args=(long_work,))
    holder.start()
    assert entered.wait(PATIENCE_S)
    stop = threading.Event()
    runner = threading.Thread(target=executor.run, args=(stop,))
    began_s = time.process_time()
    runner.start()
    runner.join(0.5)
    spent_s = time.process_time() - began_s
    stop.set()
    leave.set()
    holder.join(PATIENCE_S)
    runner.join(PATIENCE_S)
    assert spent_s < 0.1


def test_what_falls_due_is_done_though_nothing_comes_in() -> None:
    """Also where work has just moved the moment forward."""
    soon, called = threading.Event(), list[float]()
    moments = iter((FAR_S, 0.02))

    def advance(now_s: float) -> float:
        called.append(now_s)
        if len(called) >= 3:
            soon.set()
        return now_s + next(moments, FAR_S)

    executor = SerialExecutor(advance)
    began_s = clock.monotonic_s()
    executor.submit(lambda: None)
    with running(executor):
        assert soon.wait(PATIENCE_S)
    assert called[2] - began_s >= 0.02


def test_a_failure_ends_the_run_whoever_had_the_turn() -> None:
    executor = SerialExecutor(lambda now_s: now_s + FAR_S)

    def fail() -> None:
        raise ValueError("physics")

    executor.submit(fail)
    with pytest.raises(ValueError, match="physics"):
        executor.run(threading.Event())
