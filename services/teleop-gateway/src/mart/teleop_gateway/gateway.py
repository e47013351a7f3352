"""The gateway: one process for each seat of a person or a policy, there before its first offer, back within a second
of a crash. A policy's seat has a picture for those who watch, for the recording, and for whoever takes over.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging

from mart.protocol import clock, codec, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.gateway_choice import gateway_of
from mart.protocol.messages import Event, OpenSeat, OpenSeatReply, RoomStatus, error_message
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.teleop_gateway.process.seat_process_pool import SeatProcess, SeatProcessPool
from mart.teleop_gateway.process.seat_process_protocol import SERVED, SeatAssignment

_log = logging.getLogger(__name__)

OPEN_TIMEOUT_S = 5.0
_MAX_REQUEST_BYTES = 1024
_CRASH_LOOP_S = 2.0  # a process that lives shorter than this is not followed by the next one at once
_RESTART_DELAY_S = 1.0


class Gateway:
    def __init__(self, bus: AsyncBus, name: str) -> None:
        self.name = name
        self._bus = bus
        self._pool = SeatProcessPool()
        self._wanted: dict[str, frozenset[SeatAssignment]] = {}  # by room, as last told
        self._running: dict[SeatAssignment, asyncio.Task[None]] = {}
        self._gateways = {name}
        self._open: set[str] = set()  # ids of seats whose process answers offers, whoever runs it
        self._opened = asyncio.Condition()

    async def run(self) -> None:
        """Until cancelled; every seat process has ended then."""
        bus = self._bus
        with contextlib.ExitStack() as stack:
            for opened in (
                bus.watch(keys.alive_of(ServiceKind.SEAT), self._on_seat_token),
                bus.watch(keys.alive_of(ServiceKind.GATEWAY), self._on_gateway_token),
                bus.subscribe(keys.EVERY_STATUS, DecodingSubscriber(RoomStatus, self._on_status)),
                bus.serve(keys.open_seat(self.name), self._open_seat),
            ):
                stack.callback(opened.close)
            self._pool.prepare()
            try:
                await asyncio.Event().wait()
            finally:
                await self._end_all()

    # What the rooms say

    def _on_status(self, status: RoomStatus) -> None:
        arms = (seat.arm for seat in status.seats if seat.operator in SERVED)
        self._wanted[status.room] = frozenset(SeatAssignment(status.room, arm) for arm in arms)
        self._reconcile()

    def _on_gateway_token(self, key: str, alive: bool) -> None:
        (self._gateways.add if alive else self._gateways.discard)(keys.last_of(key))
        self._gateways.add(self.name)
        self._reconcile()

    def _on_seat_token(self, key: str, alive: bool) -> None:
        self._bus.spawn(self._note(keys.last_of(key), alive))

    async def _note(self, seat_id: str, alive: bool) -> None:
        async with self._opened:
            (self._open.add if alive else self._open.discard)(seat_id)
            self._opened.notify_all()

    def _reconcile(self) -> None:
        gateways = frozenset(self._gateways)
        wanted = frozenset[SeatAssignment]().union(*self._wanted.values())
        mine = {seat for seat in wanted if gateway_of(gateways, seat.room, seat.arm) == self.name}
        for seat in mine - self._running.keys():
            self._running[seat] = self._bus.spawn(self._keep(seat))
        for seat in self._running.keys() - mine:
            self._running.pop(seat).cancel()

    # One seat

    async def _keep(self, seat: SeatAssignment) -> None:
        """A process for this seat until cancelled; a dead one is told about and followed by the next."""
        while True:
            started_s = clock.monotonic_s()
            process = await self._pool.take()
            try:
                status = await self._run(process, seat)
            finally:
                await process.end()
            self._tell_loss(seat, status)
            if clock.monotonic_s() - started_s < _CRASH_LOOP_S:
                await asyncio.sleep(_RESTART_DELAY_S)

    async def _run(self, process: SeatProcess, seat: SeatAssignment) -> int:
        try:
            await process.assign(seat)
        except Unavailable as error:
            _log.warning("%s %s has no process yet: %s", seat.room, seat.arm, error)
        else:
            _log.info("%s %s is served by process %d", seat.room, seat.arm, process.pid)
        finally:
            self._pool.prepare()
        return await process.ended()

    def _tell_loss(self, seat: SeatAssignment, status: int) -> None:
        _log.warning(
            "The process of %s %s ended with status %d; the next one starts", seat.room, seat.arm, status
        )
        notice = Event.Notice(level="warning", text=f"The link of {seat.arm} broke and is being restored.")
        setattr(notice, "from", f"gateway/{self.name}")
        event = Event(wall_ns=clock.wall_ns(), room=seat.room, notice=notice)
        with contextlib.closing(self._bus.publisher(keys.event(seat.room))) as events:
            events.put(codec.encode(event))

    async def _end_all(self) -> None:
        running = list(self._running.values())
        for task in running:
            task.cancel()
        await asyncio.gather(*running, return_exceptions=True)
        await self._pool.close()

    # OpenSeat

    async def _open_seat(self, payload: bytes) -> bytes:
        """Answers once the seat's process is there, whichever gateway runs it."""
        try:
            request = codec.decode(OpenSeat, payload, limit_bytes=_MAX_REQUEST_BYTES)
            await self._await_seat(SeatAssignment(request.room, request.arm))
        except MartError as error:
            return codec.encode(OpenSeatReply(error=error_message(error)))
        return codec.encode(OpenSeatReply())

    async def _await_seat(self, seat: SeatAssignment) -> None:
        try:
            async with asyncio.timeout(OPEN_TIMEOUT_S), self._opened:
                await self._opened.wait_for(lambda: seat.id in self._open)
        except TimeoutError as error:
            raise Unavailable(
                f"{seat.arm} in {seat.room} has no process after {OPEN_TIMEOUT_S:g} s; is the seat a person's "
                "or a policy's? `mart rooms` tells."
            ) from error
