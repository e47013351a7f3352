"""Work that waits for whoever may do it."""

from __future__ import annotations

import threading

from mart.sim.room.work_queue import WorkQueue


def test_work_is_done_in_the_order_in_which_it_came() -> None:
    work_queue, done = WorkQueue(), list[int]()
    for number in range(5):
        work_queue.put(lambda number=number: done.append(number))  # type: ignore[misc]  # a lambda's default
    work_queue.run_all(timeout_s=0.0)
    assert done == [0, 1, 2, 3, 4]


def test_work_wakes_the_one_who_waits() -> None:
    work_queue, done = WorkQueue(), threading.Event()
    worker = threading.Thread(target=work_queue.run_all, args=(30.0,))
    worker.start()
    work_queue.put(done.set)
    worker.join(10.0)
    assert done.is_set()


def test_nothing_to_do_is_no_failure() -> None:
    WorkQueue().run_all(timeout_s=-1.0)
    assert not WorkQueue().run_one(timeout_s=-1.0)


def test_work_can_be_done_one_by_one() -> None:
    work_queue, done = WorkQueue(), list[int]()
    work_queue.put(lambda: done.append(1))
    work_queue.put(lambda: done.append(2))
    assert work_queue.run_one(timeout_s=0.0)
    assert done == [1]


def test_work_that_makes_work_does_not_hold_up_the_room() -> None:
    work_queue, rounds = WorkQueue(), list[int]()

    def again() -> None:
        rounds.append(1)
        work_queue.put(again)

    work_queue.put(again)
    work_queue.run_all(timeout_s=0.0)
    assert len(rounds) <= 2


def test_a_flood_is_bounded() -> None:
    work_queue, done = WorkQueue(), list[int]()
    for _ in range(100_000):
        work_queue.put(lambda: done.append(1))
    work_queue.run_all(timeout_s=0.0)
    assert 0 < len(done) <= 2000
