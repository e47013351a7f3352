"""The gateway: one process for each human seat, there before its first offer, back within a second of a crash."""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import logging
from dataclasses import dataclass, field

from mart.protocol import clock, codec, keys
from mart.protocol.bus.aio import AsyncBus
from mart.protocol.bus.base import Sample
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import OPERATOR_HUMAN, Event, OpenSeat, OpenSeatReply, RoomStatus, error_message
from mart.teleop_gateway.child import Child, Spares
from mart.teleop_gateway.seat_process import KIND as SEAT_KIND
from mart.teleop_gateway.seat_process import seat_id

_log = logging.getLogger(__name__)

KIND = "gateway"
OPEN_TIMEOUT_S = 5.0
_CRASH_LOOP_S = 2.0  # a process that lives shorter than this is not started again at once
_RESTART_DELAY_S = 1.0

SeatKey = tuple[str, str]  # room, arm


def owner(gateways: frozenset[str], seat: SeatKey) -> str:
    """Which of several gateways runs a seat: all of them reckon the same (rendezvous hashing, Thaler & Ravishankar)."""
    return max(gateways, key=lambda gateway: hashlib.sha256("/".join((gateway, *seat)).encode()).digest())


@dataclass
class Presence:
    """Which ids of one kind are alive, and a way to wait for one."""

    ids: set[str] = field(default_factory=set)
    _changed: asyncio.Condition = field(default_factory=asyncio.Condition)

    async def note(self, id: str, alive: bool) -> None:
        async with self._changed:
            (self.ids.add if alive else self.ids.discard)(id)
            self._changed.notify_all()

    async def wait_for(self, id: str) -> None:
        async with self._changed:
            await self._changed.wait_for(lambda: id in self.ids)


class Gateway:
    def __init__(self, bus: AsyncBus, name: str) -> None:
        self.name = name
        self._bus = bus
        self._spares = Spares()
        self._human: dict[str, frozenset[SeatKey]] = {}  # by room, as last told
        self._running: dict[SeatKey, asyncio.Task[None]] = {}
        self._gateways = {name}
        self._seats = Presence()

    async def run(self) -> None:
        """Until cancelled; every seat process has ended then."""
        bus = self._bus
        with contextlib.ExitStack() as stack:
            for opened in (
                bus.serve(keys.open_seat(self.name), self._open_seat),
                bus.watch(keys.alive_of(SEAT_KIND), self._on_seat_token),
                bus.watch(keys.alive_of(KIND), self._on_gateway_token),
                bus.subscribe(keys.EVERY_STATUS, self._on_status),
            ):
                stack.callback(opened.close)
            self._spares.prepare()
            try:
                await asyncio.Event().wait()
            finally:
                await self._end_all()

    # What the rooms say

    def _on_status(self, sample: Sample) -> None:
        room = keys.room_of(sample.key)
        status = codec.decode(RoomStatus, sample.payload)
        self._human[room] = frozenset(
            (room, seat.arm) for seat in status.seats if seat.operator == OPERATOR_HUMAN
        )
        self._reconcile()

    def _on_gateway_token(self, key: str, alive: bool) -> None:
        (self._gateways.add if alive else self._gateways.discard)(keys.last_of(key))
        self._gateways.add(self.name)
        self._reconcile()

    def _on_seat_token(self, key: str, alive: bool) -> None:
        self._bus.spawn(self._seats.note(keys.last_of(key), alive))

    def _reconcile(self) -> None:
        gateways = frozenset(self._gateways)
        mine = {
            seat for seats in self._human.values() for seat in seats if owner(gateways, seat) == self.name
        }
        for seat in mine - self._running.keys():
            self._running[seat] = self._bus.spawn(self._keep(seat))
        for seat in self._running.keys() - mine:
            self._running.pop(seat).cancel()

    # One seat

    async def _keep(self, seat: SeatKey) -> None:
        """A process for this seat until cancelled; a dead one is told about and followed by the next."""
        while True:
            started_s = clock.monotonic_s()
            child = await self._spares.take()
            try:
                status = await self._run(child, seat)
            finally:
                await child.end()
            self._notice(seat, status)
            if clock.monotonic_s() - started_s < _CRASH_LOOP_S:
                await asyncio.sleep(_RESTART_DELAY_S)

    async def _run(self, child: Child, seat: SeatKey) -> int:
        room, arm = seat
        try:
            await child.assign(room, arm)
        except Unavailable:
            _log.exception("The seat of %s in %s has no process yet", arm, room)
            return -1
        finally:
            self._spares.prepare()
        _log.info("%s %s is served by process %d", room, arm, child.pid)
        return await child.ended()

    def _notice(self, seat: SeatKey, status: int) -> None:
        room, arm = seat
        _log.warning("The process of %s %s ended with status %d; the next one starts", room, arm, status)
        notice = Event.Notice(level="warning", text=f"The link of {arm} broke and is being restored.")
        setattr(notice, "from", f"gateway/{self.name}")
        event = Event(wall_ns=clock.wall_ns(), room=room, notice=notice)
        with contextlib.closing(self._bus.publisher(keys.event(room))) as events:
            events.put(codec.encode(event))

    async def _end_all(self) -> None:
        running = list(self._running.values())
        for task in running:
            task.cancel()
        await asyncio.gather(*running, return_exceptions=True)
        await self._spares.close()

    # OpenSeat

    async def _open_seat(self, payload: bytes) -> bytes:
        """Answers once the seat's process is there, whichever gateway runs it."""
        try:
            request = codec.decode(OpenSeat, payload, limit_bytes=1024)
            await self._await_seat(request)
        except MartError as error:
            return codec.encode(OpenSeatReply(error=error_message(error)))
        return codec.encode(OpenSeatReply())

    async def _await_seat(self, request: OpenSeat) -> None:
        try:
            async with asyncio.timeout(OPEN_TIMEOUT_S):
                await self._seats.wait_for(seat_id(request.room, request.arm))
        except TimeoutError as error:
            raise Unavailable(
                f"{request.arm} in {request.room} has no gateway process after {OPEN_TIMEOUT_S:g} s; is the seat a "
                "person's? `mart rooms` tells."
            ) from error
