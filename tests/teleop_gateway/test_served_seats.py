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
    GONE_AFTER_SWEEPS,
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


def hear(register: SeatRegister, told: RoomStatus) -> None:
    """The sim of this room is alive and says this."""
    register.on_room(told.room, True)
    register.on_status(told)


def filled(gateway: str, *others: str) -> SeatRegister:
    """Eight rooms with two persons each."""
    register = SeatRegister(gateway)
    for other in others:
        register.on_gateway(other, True)
    for number in range(8):
        hear(register, status(f"room-{number}", OPERATOR_HUMAN, OPERATOR_HUMAN))
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
    hear(register, status("room-1", OPERATOR_HUMAN, epoch=3))
    assert register.epoch(seat) == 3
    assert register.mine() == {seat}
    hear(register, status("room-1", OPERATOR_HOLD, epoch=4))
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
    hear(register, status("ended", OPERATOR_POLICY))
    for _ in range(FORGOTTEN_AFTER_SWEEPS):
        hear(register, status("speaks", OPERATOR_POLICY))
        register.sweep()
    assert {seat.room for seat in register.mine()} == {"ended", "speaks"}
    register.sweep()
    assert {seat.room for seat in register.mine()} == {"speaks"}
    hear(register, status("ended", OPERATOR_POLICY))  # opened again
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


def test_a_room_without_a_sim_is_not_served() -> None:
    """Each seat is a process: whoever can speak on the bus could have any number of them."""
    register = SeatRegister("gateway-1")
    register.on_status(status("ghost", OPERATOR_HUMAN, OPERATOR_HUMAN))
    assert register.mine() == frozenset()


@pytest.mark.parametrize("told", [True, False])
def test_a_room_whose_sim_is_gone_is_forgotten_though_somebody_speaks_for_it(told: bool) -> None:
    register = SeatRegister("gateway-1")
    hear(register, status("room-1", OPERATOR_HUMAN))
    if told:
        register.on_room("room-1", False)
    for _ in range(GONE_AFTER_SWEEPS + 2):
        assert register.mine()
        register.on_rooms_asked([])
        register.on_status(status("room-1", OPERATOR_HUMAN))
        register.sweep()
        if not register.mine():
            break
    register.sweep()
    assert register.mine() == frozenset()


def test_a_router_that_restarts_takes_no_seat_away() -> None:
    register = SeatRegister("gateway-1")
    hear(register, status("room-1", OPERATOR_HUMAN))
    register.on_room("room-1", False)
    for _ in range(GONE_AFTER_SWEEPS):
        register.sweep()
    register.on_room("room-1", True)
    register.sweep()
    assert register.mine() == {SeatAddress("room-1", "arm0")}
