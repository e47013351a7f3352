"""A router with certificates gives each part its rights and nothing else: every part tries everything, for real."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from mart.protocol import clock, keys
from mart.protocol.keys import Priority, Topic
from mart.protocol.rights import RIGHTS, BusPart
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.access_control import access_control
from mart.runtime.bus.base import Request, Sample
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.certificates.identity import read_identity
from mart.runtime.certificates.store import ROUTER, CertificateStore
from mart.runtime.ports import free_port

pytestmark = pytest.mark.system  # real peers

NOW = dt.datetime.now(dt.UTC)
SAID = sorted({key for rights in RIGHTS.values() for key in rights.says})
SERVED = sorted({key for rights in RIGHTS.values() for key in rights.serves})
_SOON_S = 20.0


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[BusPart, ZenohBus]]:
    store = CertificateStore(tmp_path_factory.mktemp("certificates"))
    store.ensure(("127.0.0.1",), NOW)
    endpoint = f"tls/127.0.0.1:{free_port()}"
    router = read_identity(store.folder / ROUTER, NOW)
    with ExitStack() as stack:
        stack.enter_context(ZenohBus.route_secured(endpoint, router, access_control(store.admitted(NOW))))
        yield {
            part: stack.enter_context(ZenohBus.connect(endpoint, False, store.folder / part))
            for part in BusPart
        }


def test_what_is_said_reaches_whom_it_may(parts: dict[BusPart, ZenohBus]) -> None:
    heard: set[tuple[str, str, str]] = set()  # (who, what, by whom)
    with ExitStack() as stack:
        for part, bus in parts.items():
            for key in SAID:

                def hear(sample: Sample, part: BusPart = part, key: str = key) -> None:
                    heard.add((part, key, sample.payload.decode()))

                stack.callback(bus.subscribe(key, hear).close)
        expected = {
            (hearer, key, sayer)
            for key in SAID
            for hearer in BusPart
            for sayer in BusPart
            if hearer == sayer or (key in RIGHTS[hearer].hears and key in RIGHTS[sayer].says)
        }
        deadline_s = clock.monotonic_s() + _SOON_S
        while not expected <= heard and clock.monotonic_s() < deadline_s:
            for part, bus in parts.items():
                for key in SAID:
                    publisher = bus.publisher(_topic(key))
                    publisher.put(part.value.encode())
                    publisher.close()
            clock.sleep_s(0.2)
    assert heard == expected  # what a session says to itself, no router sees


def test_what_is_kept_is_given_to_whom_it_may_reach(parts: dict[BusPart, ZenohBus]) -> None:
    kept = Topic("mart/kept/state", Priority.HIGH, must_arrive=True, kept=8)
    publisher = parts[BusPart.SIM].publisher(kept)  # held: its messages are gone with it
    publisher.put(b"before")
    assert _asked_back(parts[BusPart.RECORDER], kept.key, _SOON_S) == [b"before"]
    assert _asked_back(parts[BusPart.REPLICA], kept.key, 1.0) == []
    publisher.close()


def test_questions_reach_whom_they_may(parts: dict[BusPart, ZenohBus]) -> None:
    answered: set[tuple[str, str, str]] = set()  # (who asks, what, who answers)
    with ExitStack() as stack:
        for part, bus in parts.items():
            for key in SERVED:

                def answer(request: Request, part: BusPart = part) -> None:
                    request.reply(part.value.encode())

                stack.callback(bus.serve(_topic(key, part), answer).close)
        expected = {
            (asker, key, server)
            for key in SERVED
            for asker in BusPart
            for server in BusPart
            if asker == server or (key in RIGHTS[asker].asks and key in RIGHTS[server].serves)
        }
        deadline_s = clock.monotonic_s() + _SOON_S
        while not expected <= answered and clock.monotonic_s() < deadline_s:
            for asker, bus in parts.items():
                for key in SERVED:
                    for server in BusPart:
                        reply = bus._ask(_topic(key, server), b"", 1.0, b"")
                        if reply is not None:
                            answered.add((asker, key, reply.decode()))
    assert answered == expected


def test_a_part_announces_itself_alone(parts: dict[BusPart, ZenohBus]) -> None:
    with ExitStack() as stack:
        for part, bus in parts.items():
            for kind in ServiceKind:
                stack.callback(bus.announce(keys.alive(kind, part)).close)
        expected = {keys.alive(kind, part) for part in BusPart for kind in RIGHTS[part].announces}
        deadline_s = clock.monotonic_s() + _SOON_S
        found: set[str] = set()
        own = {keys.alive(kind, BusPart.REPLICA) for kind in ServiceKind}  # a session sees its own
        while not expected <= found and clock.monotonic_s() < deadline_s:
            found = set(parts[BusPart.REPLICA].alive(keys.EVERY_ALIVE))
    assert found - own == expected - own


def _asked_back(bus: ZenohBus, key: str, within_s: float) -> list[bytes]:
    """Return what subscriptions get of what was said before; that it is kept may reach the router after them."""
    heard: list[bytes] = []
    deadline_s = clock.monotonic_s() + within_s
    while not heard and clock.monotonic_s() < deadline_s:
        subscription = bus.subscribe(key, lambda sample: heard.append(sample.payload), recover=True)
        clock.sleep_s(0.2)
        subscription.close()
    return heard


def _topic(expression: str, name: str = "x") -> Topic:
    """Return a topic that the expression meets."""
    return Topic(expression.replace("*", name), Priority.NORMAL, must_arrive=True)
