"""Whoever drives seats hears the newest of every room."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from mart.operators.room_watch import RoomWatch
from mart.protocol import codec, keys
from mart.protocol.messages import RoomStatus, State
from mart.runtime.bus.base import Bus
from mart.runtime.bus.memory import MemoryNetwork


@pytest.fixture
def bus() -> Iterator[Bus]:
    bus = MemoryNetwork().connect()
    yield bus
    bus.close()


def say_state(bus: Bus, room: str, tick: int) -> None:
    bus.publisher(keys.state(room)).put(codec.encode(State(room=room, tick=tick)))


def test_the_newest_of_every_room_once(bus: Bus) -> None:
    watch = RoomWatch(bus)
    say_state(bus, "room-1", 1)
    say_state(bus, "room-1", 2)
    say_state(bus, "room-2", 7)
    bus.publisher(keys.status("room-1")).put(codec.encode(RoomStatus(room="room-1")))
    statuses, states = watch.take(0.0)
    assert {room: state.tick for room, state in states.items()} == {"room-1": 2, "room-2": 7}
    assert statuses.keys() == {"room-1"}
    assert watch.take(0.0) == ({}, {})


def test_one_room_alone_and_nothing_after_the_end(bus: Bus) -> None:
    watch = RoomWatch(bus, "room-2")
    say_state(bus, "room-1", 1)
    say_state(bus, "room-2", 2)
    assert watch.take(0.0)[1].keys() == {"room-2"}
    watch.close()
    say_state(bus, "room-2", 3)
    assert watch.take(0.0) == ({}, {})


def test_garbage_is_counted_and_disturbs_no_other_room(bus: Bus) -> None:
    watch = RoomWatch(bus)
    bus.publisher(keys.state("room-1")).put(b"\xff")
    say_state(bus, "room-2", 2)
    assert watch.take(0.0)[1].keys() == {"room-2"}
    ((reason, count),) = watch.unusable.items()
    assert (reason.partition(":")[0], count) == ("room-1", 1)
