"""Serve the seats of every room: one process for each seat of a person or a policy, back within a second of a crash.

A process is there before its seat's first offer. A policy's seat has a picture for those who watch, for the recording,
and for whoever takes over.
"""

from __future__ import annotations

import asyncio
import contextlib

from mart.protocol import keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import RoomStatus
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.runtime.ice_servers import IceSettings
from mart.teleop_gateway.process.check_handler import CheckHandler
from mart.teleop_gateway.process.open_seat_handler import OpenSeatHandler
from mart.teleop_gateway.process.seat_keeper import SeatKeeper
from mart.teleop_gateway.served_seats import SeatRegister

ASK_EVERY_S = 2.0


class Gateway:
    """Follow what rooms and other gateways say, and keep the processes that follow from it."""

    def __init__(self, bus: AsyncBus, name: str, settings: IceSettings) -> None:
        """Make a gateway. `name` is what it is called on the bus."""
        self.name = name
        self._bus = bus
        self._register = SeatRegister(name)
        self._keeper = SeatKeeper(bus, name)
        self._opening = OpenSeatHandler(bus, self._register)
        self._checks = CheckHandler(settings)

    async def run(self) -> None:
        """Serve until cancelled; every seat process has ended then."""
        bus = self._bus
        with contextlib.ExitStack() as stack:
            for opened in (
                bus.watch(keys.alive_of(ServiceKind.SEAT), self._opening.on_seat_token),
                bus.watch(keys.alive_of(ServiceKind.GATEWAY), self._on_gateway_token),
                bus.watch(keys.alive_of(ServiceKind.SIM), self._on_room_token),
                bus.subscribe(keys.EVERY_STATUS, DecodingSubscriber(RoomStatus, self._on_status)),
                bus.serve(keys.open_seat(self.name), self._opening.answer),
                bus.serve(keys.connection_check(self.name), self._checks.answer),
            ):
                stack.callback(opened.close)
            self._keeper.prepare()
            try:
                await self._ask_periodically()
            finally:
                await self._checks.close()
                await self._keeper.close()

    def _on_status(self, status: RoomStatus) -> None:
        self._register.on_status(status)
        self._follow()

    def _on_gateway_token(self, key: str, alive: bool) -> None:
        self._register.on_gateway(keys.last_of(key), alive)
        self._follow()

    def _on_room_token(self, key: str, alive: bool) -> None:
        self._register.on_room(keys.last_of(key), alive)
        self._follow()

    async def _ask_periodically(self) -> None:
        """Ask who is alive, and forget rooms that have ended: of neither does a word have to arrive."""
        while True:
            await asyncio.sleep(ASK_EVERY_S)
            self._register.sweep()
            with contextlib.suppress(Unavailable):  # the router is away: what was known still holds
                gateways = await self._bus.alive(keys.alive_of(ServiceKind.GATEWAY))
                self._register.on_gateways_asked(map(keys.last_of, gateways))
                rooms = await self._bus.alive(keys.alive_of(ServiceKind.SIM))
                self._register.on_rooms_asked(map(keys.last_of, rooms))
            self._follow()

    def _follow(self) -> None:
        self._keeper.keep(self._register.mine())
        self._opening.on_change()
