"""The process of one seat: `python -m mart.teleop_gateway.seat_process`, started by the gateway.

It imports everything (seconds), says WARM, and waits for one line on standard input, {"room": …, "arm": …}: so a claim
is served by a process that is ready. It ends when standard input ends, and so never outlives its gateway.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys

from mart.protocol import tokens
from mart.protocol.bus.aio import AsyncBus
from mart.protocol.bus.zenoh_bus import ZenohBus
from mart.protocol.service import run_async
from mart.teleop_gateway.seat import Seat
from mart.teleop_gateway.settings import GatewaySettings

KIND = "seat"
WARM = "warm\n"


def seat_id(room: str, arm: str) -> str:
    """In the liveliness token of a seat's process."""
    return f"{room}-{arm}"


def main() -> None:
    sys.stdout.write(WARM)
    sys.stdout.flush()
    line = sys.stdin.readline()
    if not line:
        return
    assignment = json.loads(line)
    room, arm = assignment["room"], assignment["arm"]
    settings = GatewaySettings()

    async def run(bus: AsyncBus) -> None:
        secret = tokens.load_or_create_secret(settings.secret_path)
        with contextlib.closing(await asyncio.to_thread(ZenohBus.connect, settings.router)) as video_bus:
            seat = asyncio.ensure_future(
                Seat(bus, video_bus, settings, room=room, arm=arm, secret=secret).run()
            )
            gateway = asyncio.ensure_future(_end_of_input())
            try:
                await asyncio.wait((seat, gateway), return_when=asyncio.FIRST_COMPLETED)
            finally:
                gateway.cancel()
                seat.cancel()
                with contextlib.suppress(asyncio.CancelledError):
                    await seat

    run_async(settings, KIND, seat_id(room, arm), run)


async def _end_of_input() -> None:
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()
    reader = sys.stdin.fileno()

    def on_readable() -> None:
        if not os.read(reader, 4096):
            ended.set()

    loop.add_reader(reader, on_readable)
    try:
        await ended.wait()
    finally:
        loop.remove_reader(reader)


if __name__ == "__main__":
    main()
