"""Whoever drives seats hears the newest of every room."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from mart.operators.room_watch import RoomWatch
from mart.protocol import codec, keys
from mart.protocol.messages import CUE_GO, CUE_WAIT, Cue, Event, RoomStatus, State
from mart.runtime.bus.base import Bus
from mart.runtime.bus.memory import MemoryNetwork


@pytest.fixture
def bus() -> Iterator[Bus]:
    bus = MemoryNetwork().connect()
    yield bus
    bus.close()


def say_state(bus: Bus, room: str, tick: int) -> None:
    bus.publisher(keys.state(room)).put(codec.encode(State(room=room, tick=tick)))


def say_cue(bus: Bus, room: str, cue: Cue) -> None:
    given = Event.CueGiven(arm="arm0", cue=cue)
    bus.publisher(keys.event(room)).put(codec.encode(Event(room=room, cue_given=given)))


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


def test_every_cue_in_its_order_once_and_no_other_event(bus: Bus) -> None:
    watch = RoomWatch(bus)
    say_cue(bus, "room-1", CUE_WAIT)
    notice = Event(room="room-1", notice=Event.Notice(text="Hello."))
    bus.publisher(keys.event("room-1")).put(codec.encode(notice))
    bus.publisher(keys.event("room-1")).put(b"\xff")
    say_cue(bus, "room-2", CUE_GO)
    say_cue(bus, "room-1", CUE_GO)
    assert [(room, event.cue_given.cue) for room, event in watch.cues()] == [
        ("room-1", CUE_WAIT),
        ("room-2", CUE_GO),
        ("room-1", CUE_GO),
    ]
    assert watch.cues() == []
    assert sum(watch.unusable.values()) == 1


def test_who_never_looks_keeps_the_newest_cues(bus: Bus) -> None:
    watch = RoomWatch(bus, "room-1")
    for cue in (CUE_WAIT, *[CUE_GO] * 200):
        say_cue(bus, "room-1", cue)
    said = [event.cue_given.cue for _, event in watch.cues()]
    assert set(said) == {CUE_GO}
    assert len(said) < 100
