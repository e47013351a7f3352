"""Which seats a gateway serves, however much of what it is told was lost."""

from __future__ import annotations

import pytest

from mart.protocol.messages import (
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    Operator,
    RoomStatus,
)
from mart.protocol.messages import Seat as SeatMessage
from mart.teleop_gateway.served_seats import (
    FORGOTTEN_AFTER_SWEEPS,
    SeatAddress,
    SeatRegister,
    served_epochs,
)


def status(room: str, *operators: int, epoch: int = 1) -> RoomStatus:
    """Arms 0, 1, … are driven by these."""
    seats = [
        SeatMessage(arm=f"arm{i}", operator=Operator.Name(operator), epoch=epoch)
        for i, operator in enumerate(operators)
    ]
    return RoomStatus(room=room, seats=seats)


def filled(gateway: str, *others: str) -> SeatRegister:
    """Eight rooms with two persons each."""
    register = SeatRegister(gateway)
    for other in others:
        register.on_gateway(other, True)
    for number in range(8):
        register.on_status(status(f"room-{number}", OPERATOR_HUMAN, OPERATOR_HUMAN))
    return register


EVERY_SEAT = {SeatAddress(f"room-{number}", arm) for number in range(8) for arm in ("arm0", "arm1")}


def test_seats_of_people_and_policies_are_served() -> None:
    told = status("room-1", OPERATOR_HUMAN, OPERATOR_POLICY, OPERATOR_SCRIPT, OPERATOR_HOLD, epoch=4)
    assert served_epochs(told) == {SeatAddress("room-1", "arm0"): 4, SeatAddress("room-1", "arm1"): 4}


def test_what_a_room_says_last_holds() -> None:
    register = SeatRegister("gateway-1")
    seat = SeatAddress("room-1", "arm0")
    assert register.epoch(seat) is None
    assert register.mine() == frozenset()
    register.on_status(status("room-1", OPERATOR_HUMAN, epoch=3))
    assert register.epoch(seat) == 3
    assert register.mine() == {seat}
    register.on_status(status("room-1", OPERATOR_HOLD, epoch=4))
    assert register.epoch(seat) is None
    assert register.mine() == frozenset()


def test_several_gateways_serve_every_seat_once() -> None:
    names = ("gateway-1", "gateway-2", "gateway-3")
    served = [filled(name, *names).mine() for name in names]
    assert all(served)
    assert frozenset().union(*served) == EVERY_SEAT
    assert sum(map(len, served)) == len(EVERY_SEAT)


def test_a_room_that_has_ended_is_forgotten_and_one_that_speaks_is_not() -> None:
    register = SeatRegister("gateway-1")
    register.on_status(status("ended", OPERATOR_POLICY))
    for _ in range(FORGOTTEN_AFTER_SWEEPS):
        register.on_status(status("speaks", OPERATOR_POLICY))
        register.sweep()
    assert {seat.room for seat in register.mine()} == {"ended", "speaks"}
    register.sweep()
    assert {seat.room for seat in register.mine()} == {"speaks"}
    register.on_status(status("ended", OPERATOR_POLICY))  # opened again
    assert {seat.room for seat in register.mine()} == {"ended", "speaks"}


@pytest.mark.parametrize("alive", [True, False])
def test_a_gateway_whose_coming_or_going_was_not_heard_is_found_by_asking(alive: bool) -> None:
    register = filled("gateway-1", *([] if alive else ["gateway-2"]))
    wanted = filled("gateway-1", *(["gateway-2"] if alive else [])).mine()
    assert register.mine() != wanted
    answer = ["gateway-1", "gateway-2"] if alive else ["gateway-1"]
    register.on_gateways_asked(answer)
    register.on_gateways_asked(answer)
    assert register.mine() == wanted


def test_one_answer_alone_moves_no_seat() -> None:
    """It may be older than the news, or of a router that has just come back and does not know everybody yet."""
    register = filled("gateway-1", "gateway-2")
    shared = register.mine()
    register.on_gateways_asked(["gateway-1", "gateway-2"])
    register.on_gateways_asked(["gateway-1"])
    assert register.mine() == shared
    register.on_gateway("gateway-2", False)
    register.on_gateways_asked(["gateway-1", "gateway-2"])
    assert register.mine() == EVERY_SEAT


def test_a_gateway_serves_though_nobody_has_heard_of_it() -> None:
    register = filled("gateway-1")
    register.on_gateways_asked([])
    register.on_gateways_asked([])
    register.on_gateway("gateway-1", False)
    assert register.mine() == EVERY_SEAT
