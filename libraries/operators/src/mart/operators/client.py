"""Drive a seat from a program of your own, beside people: the whole way from an operator to a moving arm."""

from __future__ import annotations

import contextlib
import secrets
import threading
from collections.abc import Callable, Mapping, Sequence

from mart.operators.claim import ClaimedSeats, claimed_seats
from mart.operators.commander import SeatCommander
from mart.operators.driver import SeatAssignment, SeatDriver
from mart.operators.operator import Operator
from mart.operators.time_limit import TimeLimitedOperator
from mart.protocol import clock
from mart.protocol.errors import Conflict, Unavailable
from mart.protocol.messages import OPERATOR_POLICY, RoomStatus
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.service import Service, announced, stop_requested
from mart.runtime.settings import Settings

ROOM_SILENCE_S = 60.0  # a room that is started anew takes a moment, and remembers who sat where


def drive_seats(
    operator: Operator,
    room: str = "room-1",
    arms: Sequence[str] = ("arm0",),
    *,
    name: str = "operator",
    time_limit_s: float = 2.0,
    router: str | None = None,
    stop: threading.Event | None = None,
    seated: Callable[[], None] | None = None,
) -> None:
    """Take the seats of `arms` in `room` and let `operator` drive them until Ctrl-C, or until `stop` is set.

    `name` is what others see. People may take over and hand back. `router` is where the platform's router listens;
    None: MART_ROUTER, or this machine. `seated` is called once the seats are held.

    Raises Conflict where somebody else sits there or the last seat was given to another; NotFound for an unknown arm;
    Unavailable where room or router cannot be reached, or where the operator takes longer than `time_limit_s` seconds
    for one tick; InvalidInput where it fails or says what is no target. The seats are left in every case.

    >>> drive_seats(Riser(), arms=["arm1"])  # doctest: +SKIP
    """
    holder_id = f"operate-{secrets.token_hex(8)}"
    with contextlib.ExitStack() as stack:
        stop = stop or stack.enter_context(stop_requested())
        bus = stack.enter_context(ZenohBus.connect(router or Settings().router))
        stack.enter_context(announced(Service(ServiceKind.OPERATE, holder_id, bus, stop)))
        seats = stack.enter_context(claimed_seats(bus, room, arms, holder_id, name))
        limited = TimeLimitedOperator(operator, time_limit_s)
        assignment = ProgramAssignment(seats, name, lambda status: [_commander(limited, arms, status)])
        if seated is not None:
            seated()
        drive_claimed(SeatDriver(bus, room, assignment), seats, room, stop)


def drive_claimed(driver: SeatDriver[str], seats: ClaimedSeats, room: str, stop: threading.Event) -> None:
    """Drive until `stop` is set; raises what made the operator leave, and Conflict where all seats went to others.

    While a person has taken over it waits for the seat.
    """
    with contextlib.closing(driver):
        while not stop.is_set():
            driver.work()
            if driver.failure is not None:
                raise driver.failure
            if not seats:
                raise Conflict(f"The seat in {room} was given away or left; take one again when it is free.")
            if clock.monotonic_s() - driver.heard_s > ROOM_SILENCE_S:
                raise Unavailable(f"{room} has said nothing for {ROOM_SILENCE_S:g} s; see `mart rooms`.")


class ProgramAssignment(SeatAssignment[str]):
    """Assign the seats that were claimed for one program to it."""

    kind = ServiceKind.OPERATE

    def __init__(
        self, seats: ClaimedSeats, name: str, make: Callable[[RoomStatus], Sequence[SeatCommander]]
    ) -> None:
        self._seats, self._name, self._make = seats, name, make

    def assigned(self, room: str, status: RoomStatus) -> Mapping[str, Mapping[str, int]]:
        """Return the seats that are held now; see `SeatAssignment`."""
        epochs = self._seats.held(status)
        return {self._name: epochs} if epochs else {}

    def commanders(self, key: str, status: RoomStatus) -> Sequence[SeatCommander]:
        """Return the program's commanders; see `SeatAssignment`."""
        return self._make(status)

    def name_of(self, key: str) -> str:
        """Return the program's name; see `SeatAssignment`."""
        return key


def _commander(operator: Operator, arms: Sequence[str], status: RoomStatus) -> SeatCommander:
    return SeatCommander(operator, get_task(status.task, len(status.seats)), arms, OPERATOR_POLICY)
