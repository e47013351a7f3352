"""Run one seat: `python -m mart.teleop_gateway.process.seat_process`, started by the gateway.

It imports everything (seconds), says WARM, and waits for its assignment on standard input: so a claim is served by a
process that is ready. It ends when standard input ends, and so never outlives its gateway.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import sys

from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.log_format import set_log_context
from mart.runtime.secret_file import load_or_create_secret
from mart.runtime.service import AsyncService, run_async
from mart.teleop_gateway.process.seat_process_protocol import WARM, decode_assignment
from mart.teleop_gateway.seat import Seat
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.settings import GatewaySettings


def main() -> None:
    # Mesa's software renderer hands the strips of a picture to a pool of threads. On a machine whose cores are busy
    # each hand-over waits for a turn: two seats drew in 62 ms with the pool and in 29 ms without (2 cores, 2 browsers).
    """Import everything, say so, wait for a seat on standard input, and serve it."""
    os.environ.setdefault("LP_NUM_THREADS", "0")
    os.write(sys.stdout.fileno(), WARM)
    line = sys.stdin.buffer.readline()
    if line:
        _serve(decode_assignment(line))


def _serve(address: SeatAddress) -> None:
    settings = GatewaySettings()
    set_log_context(room=address.room, seat=address.arm)

    async def run(service: AsyncService) -> None:
        secret = load_or_create_secret(settings.secret_path)
        with contextlib.closing(await asyncio.to_thread(ZenohBus.connect, settings.router)) as video_bus:
            seat = Seat(service.bus, video_bus, settings, address, secret)
            await _until_gateway_ends(asyncio.create_task(seat.run()))

    logging.getLogger("aioice").setLevel(logging.WARNING)  # it tells about every candidate pair
    run_async(settings, ServiceKind.SEAT, address.id, run)


async def _until_gateway_ends(seat: asyncio.Task[None]) -> None:
    """Let the seat run until standard input ends: with the gateway, even when that is killed.

    The seat is told to end once, whoever says so and how often: it takes its time to close peers, view and publishers
    in that order, and another cancellation would tear it out of that.
    """
    loop, reader = asyncio.get_running_loop(), sys.stdin.fileno()

    def end() -> None:
        loop.remove_reader(reader)
        if not seat.cancelling():
            seat.cancel()

    def on_readable() -> None:
        if not os.read(reader, 4096):
            end()

    loop.add_reader(reader, on_readable)
    while not seat.done():
        try:
            await asyncio.wait([seat])
        except asyncio.CancelledError:
            end()
    loop.remove_reader(reader)
    await seat


if __name__ == "__main__":
    main()
