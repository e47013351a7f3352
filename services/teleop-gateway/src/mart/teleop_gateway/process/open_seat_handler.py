"""Answer whoever asks for a seat to be opened, once its process is there for the holder that was asked for."""

from __future__ import annotations

import asyncio
import contextlib

from mart.protocol import keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import OpenSeat, OpenSeatReply
from mart.protocol.queryables import OPEN_SEAT
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.serving import AsyncRequestAnswerer
from mart.teleop_gateway.change_signal import ChangeSignal
from mart.teleop_gateway.served_seats import SeatAddress, SeatRegister

OPEN_TIMEOUT_S = 5.0
_ASK_AFTER_S = 0.5


class OpenSeatHandler:
    """Know which seats' processes answer offers, whichever gateway runs them.

    `answer` replies to an OpenSeat: with nothing once the seat can take an offer, with the error where it cannot.
    """

    def __init__(self, bus: AsyncBus, register: SeatRegister) -> None:
        """Answer with `register`, which tells the newest epoch of every seat; call `on_change` whenever it has news."""
        self._bus, self._register = bus, register
        self._open: set[str] = set()  # ids of seats
        self._changed = ChangeSignal()
        self.answer = AsyncRequestAnswerer(OPEN_SEAT, self._answer)

    def on_seat_token(self, key: str, alive: bool) -> None:
        """Take the news that the process of a seat came or went."""
        (self._open.add if alive else self._open.discard)(keys.last_of(key))
        self.on_change()

    def on_change(self) -> None:
        """Look anew whether what somebody waits for is there."""
        self._changed.tell()

    async def _answer(self, request: OpenSeat) -> OpenSeatReply:
        await self._await_open(SeatAddress(request.room, request.arm), request.seat_epoch)
        return OpenSeatReply()

    async def _await_open(self, seat: SeatAddress, epoch: int) -> None:
        try:
            async with asyncio.timeout(OPEN_TIMEOUT_S):
                while not self._is_open(seat, epoch):
                    await self._await_news(seat)
        except TimeoutError as error:
            raise Unavailable(
                f"{seat.arm} in {seat.room} has no process after {OPEN_TIMEOUT_S:g} s; is the seat a person's "
                "or a policy's? `mart rooms` tells."
            ) from error

    def _is_open(self, seat: SeatAddress, epoch: int) -> bool:
        """Tell whether its process is there, and is not the one of an earlier holder, about to end.

        An epoch older than the newest is no reason to refuse: viewers may stay while a seat changes hands. The seat's
        process looks at the token.
        """
        known_epoch = self._register.epoch(seat) or 0
        return seat.id in self._open and known_epoch >= epoch  # 0 where whoever asks did not say

    async def _await_news(self, seat: SeatAddress) -> None:
        """Wait for a change, and ask where none comes: the word that a process is there may have been lost."""
        try:
            async with asyncio.timeout(_ASK_AFTER_S):
                await self._changed.wait()
        except TimeoutError:
            with contextlib.suppress(Unavailable):  # the router is away: ask again
                token = keys.alive(ServiceKind.SEAT, seat.id)
                if await asyncio.to_thread(self._bus.bus.alive, token):
                    self._open.add(seat.id)
