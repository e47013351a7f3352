"""Keep seats served: a process for each, and another one when it dies."""

from __future__ import annotations

import asyncio
import contextlib
import logging

from mart.protocol import clock, codec, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import Event
from mart.runtime.bus.aio import AsyncBus
from mart.teleop_gateway.process.gateway_metrics import LOST_PROCESSES, SEATS
from mart.teleop_gateway.process.seat_process_pool import SeatProcess, SeatProcessPool
from mart.teleop_gateway.served_seats import SeatAddress

_log = logging.getLogger(__name__)

_CRASH_LOOP_S = 2.0  # a process that lives shorter than this is not followed by the next one at once
_RESTART_DELAY_S = 1.0  # doubled each time, where it happens again and again
_LONGEST_DELAY_S = 8.0


class SeatKeeper:
    """Hold one process for each seat of a set that may change at any time."""

    def __init__(self, bus: AsyncBus, gateway: str) -> None:
        """Keep processes of the gateway of this name, which signs what it tells the rooms."""
        self._bus, self._gateway = bus, gateway
        self._pool = SeatProcessPool()
        self._kept: dict[SeatAddress, asyncio.Task[None]] = {}

    def prepare(self) -> None:
        """Warm up a process ahead of the first seat."""
        self._pool.prepare()

    def keep(self, seats: frozenset[SeatAddress]) -> None:
        """Serve exactly these seats from now on; processes of others end."""
        for seat in self._kept.keys() - seats:
            self._kept.pop(seat).cancel()
        for seat in seats:
            if seat not in self._kept or self._kept[seat].done():  # done: the machine could start no process
                self._kept[seat] = self._bus.spawn(self._keep(seat))
        SEATS.set(len(self._kept))

    async def close(self) -> None:
        """Return when every process has ended."""
        kept = list(self._kept.values())
        self._kept.clear()
        for task in kept:
            task.cancel()
        await asyncio.gather(*kept, return_exceptions=True)
        await self._pool.close()

    async def _keep(self, seat: SeatAddress) -> None:
        """Hold a process for this seat until cancelled; a dead one is told about and followed by the next."""
        delay_s = _RESTART_DELAY_S
        while True:
            started_s = clock.monotonic_s()
            try:
                await self._hold(seat)
            except Exception as error:  # noqa: BLE001 - no memory, no descriptors, no bus: it may be better in a moment
                _log.error(
                    "%s %s has no process and gets one in %g s: %r", seat.room, seat.arm, delay_s, error
                )
            if clock.monotonic_s() - started_s >= _CRASH_LOOP_S:
                delay_s = _RESTART_DELAY_S
                continue
            await asyncio.sleep(delay_s)
            delay_s = min(2.0 * delay_s, _LONGEST_DELAY_S)

    async def _hold(self, seat: SeatAddress) -> None:
        process = await self._pool.take()
        try:
            status = await self._run(process, seat)
        finally:
            await process.end()
        self._tell_loss(seat, status)

    async def _run(self, process: SeatProcess, seat: SeatAddress) -> int:
        try:
            await process.assign(seat)
        except Unavailable as error:
            _log.warning("%s %s has no process yet: %s", seat.room, seat.arm, error)
        else:
            _log.info("%s %s is served by process %d", seat.room, seat.arm, process.pid)
        finally:
            self._pool.prepare()
        return await process.ended()

    def _tell_loss(self, seat: SeatAddress, status: int) -> None:
        LOST_PROCESSES.inc()
        _log.warning(
            "The process of %s %s ended with status %d; the next one starts", seat.room, seat.arm, status
        )
        notice = Event.Notice(level="warning", text=f"The link of {seat.arm} broke and is being restored.")
        setattr(notice, "from", f"gateway/{self._gateway}")
        event = Event(wall_ns=clock.wall_ns(), room=seat.room, notice=notice)
        with contextlib.closing(self._bus.publisher(keys.event(seat.room))) as events:
            events.put(codec.encode(event))
