"""Seats that a program holds: driven while they are its own, waited for while a person drives."""

from __future__ import annotations

import contextlib

import pytest

from mart.operators.claim import ClaimedSeats, claimed_seats
from mart.operators.room_client import RoomClient
from mart.protocol.errors import Unavailable
from mart.protocol.messages import OPERATOR_POLICY, Operator, Seat
from mart.runtime.bus.memory import MemoryNetwork
from tests.operators.rooms import seat_of, status_of
from tests.web.room import Room


def test_ones_own_seat_may_come_back_from_a_person_and_from_nobody_else() -> None:
    seats = ClaimedSeats("me", [seat_of("arm0", 2, "me"), seat_of("arm1", 2, "me")])
    own = [seat_of("arm0", 2, "me"), seat_of("arm1", 2, "me")]
    assert seats.held(status_of(own)) == {"arm0": 2, "arm1": 2}
    taken = seat_of("arm0", 3, "ana")
    taken.relieved = "mine"
    assert seats.held(status_of([taken, own[1]])) == {"arm1": 2}
    assert seats.held(status_of([seat_of("arm0", 4, "me"), own[1]])) == {"arm0": 4, "arm1": 2}
    assert seats.held(status_of([seat_of("arm0", 5, "ben"), own[1]])) == {"arm1": 2}
    assert seats.held(status_of([seat_of("arm0", 6, "me"), own[1]])) == {"arm1": 2}
    assert seats
    assert seats.held(status_of([seat_of("arm0", 6, ""), seat_of("arm1", 3, "")])) == {}
    assert not seats


def test_an_old_status_gives_nothing_away() -> None:
    seats = ClaimedSeats("me", [seat_of("arm0", 5, "me")])
    assert seats.held(status_of([seat_of("arm0", 4, "ana")])) == {}
    assert seats


def test_a_seat_that_was_given_too_late_to_be_told_is_left() -> None:
    class Late(RoomClient):
        """The room does what it is asked; the answer to the claim is lost."""

        def claim(self, arm: str, holder_id: str, name: str, operator: Operator = OPERATOR_POLICY) -> Seat:
            super().claim(arm, holder_id, name, operator)
            raise Unavailable("Nobody answered in time.")

    bus = MemoryNetwork().connect()
    with contextlib.closing(Room(bus)) as room:
        with pytest.raises(Unavailable), claimed_seats(Late(bus, room.name), ["arm0"], "me", "mine"):
            pass
        assert room.seats["arm0"].holder_id == ""
