"""A seat is open when its process is there for the holder that was asked for, whatever was heard of it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import OPERATOR_HUMAN, OpenSeat, OpenSeatReply, Operator, RoomStatus
from mart.protocol.messages import Seat as SeatMessage
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.process import open_seat_handler
from mart.teleop_gateway.process.open_seat_handler import OpenSeatHandler
from mart.teleop_gateway.served_seats import SeatAddress, SeatRegister

SEAT = SeatAddress("room-1", "arm0")
TOKEN = keys.alive(ServiceKind.SEAT, SEAT.id)


class Opening:
    """A handler and what goes on around it."""

    def __init__(self) -> None:
        self.network = MemoryNetwork()
        self.register = SeatRegister("gateway-1")
        self.register.on_room(SEAT.room, True)
        self.handler = OpenSeatHandler(
            AsyncBus(self.network.connect(), asyncio.get_running_loop()), self.register
        )

    def ask(self, epoch: int = 0) -> asyncio.Task[str]:
        """Ask for the seat; the code of the error, "" where there is none."""

        async def code() -> str:
            request = codec.encode(OpenSeat(room=SEAT.room, arm=SEAT.arm, seat_epoch=epoch))
            return codec.decode(OpenSeatReply, await self.handler.answer(request)).error.code

        return asyncio.create_task(code())

    def tell_epoch(self, epoch: int) -> None:
        seat = SeatMessage(arm=SEAT.arm, operator=Operator.Name(OPERATOR_HUMAN), epoch=epoch)
        self.register.on_status(RoomStatus(room=SEAT.room, seats=[seat]))
        self.handler.on_change()


def on_opening(body: Callable[[Opening], Awaitable[None]]) -> None:
    async def main() -> None:
        async with asyncio.timeout(30):
            await body(Opening())

    asyncio.run(main())


async def is_waiting(asked: asyncio.Task[str]) -> bool:
    for _ in range(10):
        await asyncio.sleep(0)
    return not asked.done()


def test_a_seat_is_open_as_soon_as_its_process_is_heard_of() -> None:
    async def body(opening: Opening) -> None:
        asked = opening.ask()
        assert await is_waiting(asked)
        opening.handler.on_seat_token(TOKEN, True)
        assert await asked == ""
        assert await opening.ask() == ""
        opening.handler.on_seat_token(TOKEN, False)
        assert await is_waiting(opening.ask())

    on_opening(body)


def test_a_process_whose_coming_was_not_heard_is_found_by_asking() -> None:
    async def body(opening: Opening) -> None:
        opening.network.connect().announce(TOKEN)  # nothing tells the handler
        assert await opening.ask() == ""

    on_opening(body)


def test_the_process_of_an_earlier_holder_is_not_taken_for_that_of_a_later_one() -> None:
    async def body(opening: Opening) -> None:
        opening.tell_epoch(3)
        opening.handler.on_seat_token(TOKEN, True)
        asked = opening.ask(epoch=5)  # the room has told the web service already
        assert await is_waiting(asked)
        opening.handler.on_seat_token(TOKEN, False)
        opening.tell_epoch(5)
        assert await is_waiting(asked)
        opening.handler.on_seat_token(TOKEN, True)
        assert await asked == ""

    on_opening(body)


def test_who_asks_with_an_older_token_may_still_be_a_viewer() -> None:
    async def body(opening: Opening) -> None:
        opening.tell_epoch(3)
        opening.handler.on_seat_token(TOKEN, True)
        assert await opening.ask(epoch=2) == ""

    on_opening(body)


def test_a_seat_that_nobody_serves_is_unavailable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(open_seat_handler, "OPEN_TIMEOUT_S", 0.6)  # it is asked for once in that time

    async def body(opening: Opening) -> None:
        assert await opening.ask() == "Unavailable"

    on_opening(body)
