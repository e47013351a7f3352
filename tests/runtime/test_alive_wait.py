"""Waiting for services, whether their coming is told of or not."""

from __future__ import annotations

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus.memory import MemoryNetwork
from tests.support.deaf_bus import DeafBus, DistantBus

REPLICA = keys.alive(ServiceKind.REPLICA, "a")
EVERY_REPLICA = keys.alive_of(ServiceKind.REPLICA)
WAIT_S = 30.0


def test_who_is_there_is_found_at_once() -> None:
    bus = MemoryNetwork().connect()
    bus.announce(REPLICA)
    assert await_alive(bus, EVERY_REPLICA, {REPLICA}, WAIT_S) == {REPLICA}


def test_who_came_unheard_is_found() -> None:
    network = MemoryNetwork()
    network.connect().announce(REPLICA)
    assert await_alive(DeafBus(network), EVERY_REPLICA, {REPLICA}, WAIT_S) == {REPLICA}


def test_who_is_missing_is_not_waited_for_for_ever() -> None:
    bus = MemoryNetwork().connect()
    bus.announce(REPLICA)
    assert await_alive(bus, EVERY_REPLICA, {keys.alive(ServiceKind.REPLICA, "b")}, 0.1) == {REPLICA}


def test_a_router_that_does_not_answer_is_asked_again() -> None:
    network = MemoryNetwork()
    network.connect().announce(REPLICA)
    assert await_alive(DistantBus(network), EVERY_REPLICA, {REPLICA}, WAIT_S) == {REPLICA}
