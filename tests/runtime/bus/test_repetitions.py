"""A repeated request is done once, whatever the order of asking and answering."""

from __future__ import annotations

import queue
from concurrent.futures import ThreadPoolExecutor

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import keys
from mart.runtime.bus.base import Request
from mart.runtime.bus.repetitions import AskedOnce, Repetitions
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.support.processes import running_router

WAIT_S = 30.0


class Asker:
    def __init__(self) -> None:
        self.answers: list[bytes] = []

    def answer(self, payload: bytes) -> None:
        self.answers.append(payload)


@given(st.lists(st.tuples(st.sampled_from("abc"), st.booleans())))
def test_every_asker_gets_the_one_answer_to_what_it_asked(course: list[tuple[str, bool]]) -> None:
    repetitions = Repetitions()
    askers: dict[str, list[Asker]] = {"a": [], "b": [], "c": []}
    to_do: dict[str, AskedOnce] = {}
    done: set[str] = set()
    for name, answered in course:
        if answered and name in to_do:
            to_do.pop(name).reply(name.encode())
            done.add(name)
        else:
            asker = Asker()
            request = repetitions.ask(name.encode(), "key", b"", asker)
            assert (request is None) == bool(askers[name])
            askers[name].append(asker)
            to_do |= {} if request is None else {name: request}
    for name, asked in askers.items():
        assert all(asker.answers == [name.encode()] * (name in done) for asker in asked)


def test_what_was_let_go_without_an_answer_is_done_anew() -> None:
    repetitions, asker = Repetitions(), Asker()
    assert repetitions.ask(b"id", "key", b"first", Asker()) is not None  # and nobody keeps it
    request = repetitions.ask(b"id", "key", b"first", asker)
    assert request is not None
    request.reply(b"done")
    assert asker.answers == [b"done"]


def test_who_asks_without_an_id_asks_something_new() -> None:
    repetitions = Repetitions()
    first = repetitions.ask(b"", "key", b"", Asker())
    second = repetitions.ask(b"", "key", b"", Asker())
    assert first is not None
    assert second is not None
    first.reply(b"done")
    assert repetitions.ask(b"", "key", b"", Asker()) is not None


def test_only_the_newest_answers_and_no_large_ones_are_remembered() -> None:
    repetitions = Repetitions()

    def do(id: bytes, answer: bytes) -> bool:
        request = repetitions.ask(id, "key", b"", Asker())
        if request is not None:
            request.reply(answer)
        return request is not None

    assert do(b"large", bytes(100_000))
    assert do(b"large", b"")
    numbers = [bytes([number]) for number in range(70)]
    assert all(do(number, b"") for number in numbers)
    assert not do(numbers[-1], b"")
    assert do(numbers[0], b"")


@pytest.mark.system
def test_a_request_whose_answer_is_lost_with_the_router_is_done_once() -> None:
    port, topic = free_port(), keys.seat("room-1")
    endpoint = f"tcp/127.0.0.1:{port}"
    heard: queue.SimpleQueue[Request] = queue.SimpleQueue()
    with ThreadPoolExecutor() as executor:
        with running_router(port):
            asking, serving = ZenohBus.connect(endpoint), ZenohBus.connect(endpoint)
            serving.serve(topic, heard.put)
            answer = executor.submit(asking.query, topic, b"abc", WAIT_S)
            request = heard.get(timeout=WAIT_S)
        with running_router(port), asking, serving:
            request.reply(b"cba")
            assert answer.result(timeout=WAIT_S) == b"cba"
    assert heard.empty()
