"""Work that waits for whoever may do it."""

from __future__ import annotations

import threading

from mart.sim.room.work_queue import Mailbox


def test_work_is_done_in_the_order_in_which_it_came() -> None:
    mailbox, done = Mailbox(), list[int]()
    for number in range(5):
        mailbox.put(lambda number=number: done.append(number))  # type: ignore[misc]  # a lambda's default
    mailbox.work(timeout_s=0.0)
    assert done == [0, 1, 2, 3, 4]


def test_work_wakes_the_one_who_waits() -> None:
    mailbox, done = Mailbox(), threading.Event()
    worker = threading.Thread(target=mailbox.work, args=(30.0,))
    worker.start()
    mailbox.put(done.set)
    worker.join(10.0)
    assert done.is_set()


def test_nothing_to_do_is_no_failure() -> None:
    Mailbox().work(timeout_s=-1.0)
    assert not Mailbox().work_once(timeout_s=-1.0)


def test_work_can_be_done_one_by_one() -> None:
    mailbox, done = Mailbox(), list[int]()
    mailbox.put(lambda: done.append(1))
    mailbox.put(lambda: done.append(2))
    assert mailbox.work_once(timeout_s=0.0)
    assert done == [1]


def test_work_that_makes_work_does_not_hold_up_the_room() -> None:
    mailbox, rounds = Mailbox(), list[int]()

    def again() -> None:
        rounds.append(1)
        mailbox.put(again)

    mailbox.put(again)
    mailbox.work(timeout_s=0.0)
    assert len(rounds) <= 2


def test_a_flood_is_bounded() -> None:
    mailbox, done = Mailbox(), list[int]()
    for _ in range(100_000):
        mailbox.put(lambda: done.append(1))
    mailbox.work(timeout_s=0.0)
    assert 0 < len(done) <= 2000
