"""Words of people reach what drives in their room, over an in-memory bus."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence

import pytest

from mart.operators.commander import SeatCommander
from mart.operators.driver import SeatDriver, SeatSelection
from mart.protocol import codec, keys
from mart.protocol.messages import (
    CUE_GO,
    CUE_WAIT,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
    Cue,
    Event,
    Operator,
    RoomStatus,
    Seat,
)
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.memory import MemoryNetwork
from tests.operators.rooms import TASK, Riser, state_of, status_of


class Listener(Riser):
    """A riser that keeps the cues that it hears; a beginning is None."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: list[Cue | None] = []

    def begin(self, episode: int) -> None:
        self.heard.append(None)

    def on_cue(self, cue: Cue, arm: str) -> None:
        self.heard.append(cue)


class Alone(SeatSelection[str]):
    """One operator at arm0, whoever holds the seats."""

    kind = ServiceKind.EXPERTS

    def __init__(self, listener: Listener) -> None:
        self._listener = listener

    def assigned(self, room: str, status: RoomStatus) -> Mapping[str, Mapping[str, int]]:
        return {"it": {"arm0": 2}}

    def commanders(self, key: str, status: RoomStatus) -> Sequence[SeatCommander]:
        return [SeatCommander(self._listener, TASK, ("arm0",), OPERATOR_SCRIPT)]

    def name_of(self, key: str) -> str:
        return key


class Room:
    """A room of two seats that says what it is told to say, and who listens there."""

    def __init__(self) -> None:
        self.listener = Listener()
        self._bus = MemoryNetwork().connect()
        self.driver = SeatDriver(self._bus, None, Alone(self.listener))

    def seated(self, partner: Operator) -> None:
        seats = [Seat(arm="arm0", epoch=2, operator=OPERATOR_SCRIPT), Seat(arm="arm1", operator=partner)]
        self._bus.publisher(keys.status("room-1")).put(codec.encode(status_of(seats)))

    def show(self, tick: int, *, after_reset: bool = False) -> None:
        state = state_of(tick, after_reset=after_reset)
        self._bus.publisher(keys.state("room-1")).put(codec.encode(state))

    def say(self, cue: Cue, tick: int, room: str = "room-1", arm: str = "arm1") -> None:
        given = Event.CueGiven(arm=arm, cue=cue)
        event = Event(room=room, tick=tick, cue_given=given)
        self._bus.publisher(keys.event(room)).put(codec.encode(event))

    def close(self) -> None:
        self.driver.close()
        self._bus.close()


@pytest.fixture
def room() -> Iterator[Room]:
    with contextlib.closing(Room()) as room:
        room.seated(OPERATOR_HUMAN)
        room.show(1)
        room.driver.work()
        assert room.listener.heard == [None]
        yield room


def test_what_a_person_says_is_heard_in_that_room_alone(room: Room) -> None:
    room.say(CUE_WAIT, tick=1)
    room.say(CUE_GO, tick=1, room="room-2")
    room.say(CUE_GO, tick=1, arm="arm0")  # its own seat
    room.driver.work()
    assert room.listener.heard == [None, CUE_WAIT]


def test_nobody_but_people_is_heard(room: Room) -> None:
    room.seated(OPERATOR_SCRIPT)
    room.say(CUE_WAIT, tick=1)
    room.driver.work()
    assert room.listener.heard == [None]


def test_of_words_around_a_reset_those_after_it_are_heard(room: Room) -> None:
    room.say(CUE_GO, tick=4)
    room.show(5, after_reset=True)
    room.say(CUE_WAIT, tick=5)
    room.driver.work()
    assert room.listener.heard == [None, None, CUE_WAIT]
