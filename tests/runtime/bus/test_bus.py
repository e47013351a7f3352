"""One suite for every bus: what holds in memory holds on Zenoh."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from mart.protocol import keys
from mart.protocol.errors import Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus.base import Bus, Request, Sample
from mart.runtime.bus.memory import MemoryNetwork
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.support.processes import running_router, running_service

Connect = Callable[[], Bus]
WAIT_S = 30.0


@pytest.fixture(params=["memory", "zenoh"])
def connect(request: pytest.FixtureRequest) -> Iterator[Connect]:
    opened: list[Bus] = []

    def keep(bus: Bus) -> Bus:
        opened.append(bus)
        return bus

    if request.param == "memory":
        network = MemoryNetwork()
        yield lambda: keep(network.connect())
    else:
        endpoint = request.getfixturevalue("endpoint")
        yield lambda: keep(ZenohBus.connect(endpoint))
    for bus in opened:
        bus.close()


class Inbox:
    """Collects samples; `next()` waits for one."""

    def __init__(self) -> None:
        self._samples: queue.Queue[Sample] = queue.Queue()

    def __call__(self, sample: Sample) -> None:
        self._samples.put(sample)

    def next(self) -> Sample:
        return self._samples.get(timeout=WAIT_S)

    @property
    def empty(self) -> bool:
        return self._samples.empty()


def answering(answer: Callable[[bytes], bytes]) -> Callable[[Request], None]:
    return lambda request: request.reply(answer(request.payload))


def settled(bus: Bus, topic: keys.Topic) -> None:
    """A round trip through the router: declarations made before it are known there."""
    server = bus.serve(topic, answering(lambda payload: payload))
    assert bus.query(topic, b"?", WAIT_S) == b"?"
    server.close()


def test_a_put_reaches_every_subscriber_of_its_key(connect: Connect) -> None:
    a, b = connect(), connect()
    inboxes = [Inbox(), Inbox()]
    b.subscribe(keys.state("room-1").key, inboxes[0])
    b.subscribe(keys.EVERY_STATE, inboxes[1])
    settled(b, keys.model("room-1"))
    a.publisher(keys.state("room-1")).put(b"hello")
    assert [inbox.next() for inbox in inboxes] == [Sample("mart/room-1/state", b"hello")] * 2


def test_a_wildcard_takes_its_segment_and_no_other(connect: Connect) -> None:
    a, b = connect(), connect()
    inbox = Inbox()
    b.subscribe(keys.commands("room-1"), inbox)
    settled(b, keys.model("room-1"))
    a.publisher(keys.command("room-2", "arm0")).put(b"other room")
    a.publisher(keys.state("room-1")).put(b"other key")
    a.publisher(keys.command("room-1", "arm1")).put(b"mine")
    assert inbox.next() == Sample("mart/room-1/arm/arm1/command", b"mine")
    assert inbox.empty


def test_puts_of_one_publisher_arrive_in_order(connect: Connect) -> None:
    a, b = connect(), connect()
    inbox = Inbox()
    b.subscribe(keys.event("room-1").key, inbox)
    settled(b, keys.model("room-1"))
    publisher = a.publisher(keys.event("room-1"))
    for number in range(200):
        publisher.put(str(number).encode())
    assert [inbox.next().payload for _ in range(200)] == [str(number).encode() for number in range(200)]


def test_a_large_payload_arrives_whole(connect: Connect) -> None:
    a, b = connect(), connect()
    inbox = Inbox()
    b.subscribe(keys.event("room-1").key, inbox)
    settled(b, keys.model("room-1"))
    payload = bytes(range(256)) * 12_000
    a.publisher(keys.event("room-1")).put(payload)
    assert inbox.next().payload == payload


def test_a_closed_subscription_hears_nothing_more(connect: Connect) -> None:
    a, b = connect(), connect()
    closed, open_ = Inbox(), Inbox()
    b.subscribe(keys.state("room-1").key, closed).close()
    b.subscribe(keys.state("room-1").key, open_)
    settled(b, keys.model("room-1"))
    a.publisher(keys.state("room-1")).put(b"x")
    open_.next()
    assert closed.empty


def test_a_query_is_answered(connect: Connect) -> None:
    a, b = connect(), connect()
    b.serve(keys.seat("room-1"), answering(lambda payload: payload[::-1]))
    settled(b, keys.model("room-1"))
    assert a.query(keys.seat("room-1"), b"abc", WAIT_S) == b"cba"


def test_a_query_that_nobody_answers_says_so(connect: Connect) -> None:
    with pytest.raises(Unavailable, match="mart/room-9/seat"):
        connect().query(keys.seat("room-9"), b"", 0.3)


def test_a_query_waits_for_a_service_that_is_just_starting(endpoint: str) -> None:
    topic = keys.seat("room-1")
    with (
        ZenohBus.connect(endpoint) as asking,
        ZenohBus.connect(endpoint) as serving,
        ThreadPoolExecutor() as executor,
    ):
        answer = executor.submit(asking.query, topic, b"abc", WAIT_S)
        with pytest.raises(TimeoutError):
            answer.result(timeout=0.2)
        serving.serve(topic, answering(lambda payload: payload[::-1]))
        assert answer.result(timeout=WAIT_S) == b"cba"


def test_a_request_that_was_dropped_is_asked_again(endpoint: str) -> None:
    topic = keys.seat("room-1")
    heard: list[bytes] = []

    def answer_the_third(request: Request) -> None:
        heard.append(request.payload)
        if len(heard) == 3:
            request.reply(b"cba")

    with ZenohBus.connect(endpoint) as asking, ZenohBus.connect(endpoint) as serving:
        serving.serve(topic, answer_the_third)
        assert asking.query(topic, b"abc", WAIT_S) == b"cba"
    assert heard == [b"abc"] * 3


def test_liveliness_is_seen_by_early_and_late_watchers_and_ends_with_its_holder(connect: Connect) -> None:
    a, b = connect(), connect()
    early: queue.Queue[tuple[str, bool]] = queue.Queue()
    late: queue.Queue[tuple[str, bool]] = queue.Queue()
    b.watch(keys.alive_of(ServiceKind.SIM), lambda key, alive: early.put((key, alive)))
    settled(b, keys.model("room-1"))
    key = keys.alive(ServiceKind.SIM, "room-1")
    a.announce(key)
    assert early.get(timeout=WAIT_S) == (key, True)
    b.watch(keys.alive_of(ServiceKind.SIM), lambda key, alive: late.put((key, alive)))
    assert late.get(timeout=WAIT_S) == (key, True)
    while not (
        alive := b.alive(keys.EVERY_ALIVE)
    ):  # on a busy machine, news are ahead of answers by a moment
        pass
    assert alive == [key]
    a.close()
    assert early.get(timeout=WAIT_S) == (key, False)
    assert late.get(timeout=WAIT_S) == (key, False)


def test_only_the_watched_kind_is_reported(connect: Connect) -> None:
    a, b = connect(), connect()
    seen: queue.Queue[tuple[str, bool]] = queue.Queue()
    b.watch(keys.alive_of(ServiceKind.WEB), lambda key, alive: seen.put((key, alive)))
    settled(b, keys.model("room-1"))
    a.announce(keys.alive(ServiceKind.SIM, "room-1"))
    a.announce(keys.alive(ServiceKind.WEB, "web"))
    assert seen.get(timeout=WAIT_S) == (keys.alive(ServiceKind.WEB, "web"), True)
    assert seen.empty()


def test_a_client_that_does_not_wait_says_that_there_is_no_router() -> None:
    with pytest.raises(Unavailable, match="router"):
        ZenohBus.connect(f"tcp/127.0.0.1:{free_port()}", wait_for_router=False)


@pytest.mark.system
def test_a_router_that_says_nothing_is_not_a_system_without_services() -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    command = ["router", "--listen", endpoint]
    with (
        running_service(command, endpoint, None, kind="router", id="router") as router,
        ZenohBus.connect(endpoint) as bus,
        router.frozen(),
        pytest.raises(Unavailable, match="who is alive"),
    ):
        bus.alive(keys.EVERY_ALIVE)


@pytest.mark.system
def test_nobody_is_left_out_while_others_ask_and_watch() -> None:
    """One answer in a thousand left a service out, and an episode was not verified."""
    key = keys.alive(ServiceKind.REPLICA, "replica-1")
    with running_router() as endpoint, ZenohBus.connect(endpoint) as a, ZenohBus.connect(endpoint) as b:
        a.announce(key)
        assert await_alive(b, key, {key}, WAIT_S)
        b.watch(key, lambda _key, _alive: None)
        expressions = (key, keys.alive_of(ServiceKind.REPLICA), keys.EVERY_ALIVE)
        with ThreadPoolExecutor() as threads:
            asked = [threads.submit(b.alive, expression) for _ in range(200) for expression in expressions]
            assert all(key in one.result() for one in asked)


@pytest.mark.system
def test_a_router_that_is_away_is_not_a_system_without_services() -> None:
    port = free_port()
    key = keys.alive(ServiceKind.SIM, "room-1")
    with running_router(port) as endpoint:
        a, b = ZenohBus.connect(endpoint), ZenohBus.connect(endpoint)
        a.announce(key)
        assert await_alive(b, key, {key}, WAIT_S)
    with a, b:
        with pytest.raises(Unavailable, match="who is alive"):
            b.alive(keys.EVERY_ALIVE)
        with running_router(port):
            assert await_alive(b, key, {key}, WAIT_S) == {key}


@pytest.mark.system
def test_what_was_put_while_there_was_no_router_is_asked_for_again() -> None:
    port, inbox = free_port(), Inbox()
    with running_router(port) as endpoint:
        a, b = ZenohBus.connect(endpoint), ZenohBus.connect(endpoint)
        b.subscribe(keys.EVERY_STATE, inbox, recover=True)
        settled(b, keys.model("room-1"))
        publisher = a.publisher(keys.state("room-1"))
        publisher.put(b"0")
        assert inbox.next().payload == b"0"
    missed = [str(number).encode() for number in range(1, 20)]
    for payload in missed:
        publisher.put(payload)
    with running_router(port), a, b:
        assert [inbox.next().payload for _ in missed] == missed
