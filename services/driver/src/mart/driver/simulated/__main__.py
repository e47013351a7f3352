"""Run simulated hardware behind a socket: `python -m mart.driver.simulated --port 9000`.

Each line that comes is a JSON object: `servo` and `gripper`, `stop`, or what a rehearsal asks: `fault` (its name),
`cut_s` (for how long nobody is connected), `history_s` (where the joints were, in one line).
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from typing import Any

import click

from mart.driver.scheduling import go_first
from mart.driver.simulated.hardware import SERVO_HZ, ArmHardware, HardwareFault
from mart.protocol import clock

_HOME_RAD = "0,0.2,0,-2.1,0,2.3,0.785"  # a Panda, elbow up and tool down
_MOST_WAITING_BYTES = 65536


class HardwareServer:
    """Serve one arm's hardware to whoever connects."""

    def __init__(self, hardware: ArmHardware) -> None:
        self._hardware = hardware
        self._clients: set[asyncio.StreamWriter] = set()
        self._cut_until_s = 0.0

    async def serve(self, port: int) -> None:
        """Serve on 127.0.0.1 until cancelled; the port is printed, one line."""
        server = await asyncio.start_server(self._client, "127.0.0.1", port, limit=_MOST_WAITING_BYTES)
        click.echo(server.sockets[0].getsockname()[1])
        async with server:
            await self._run()

    async def _run(self) -> None:
        last_s = due_s = clock.monotonic_s()
        while True:
            due_s = max(due_s + 1.0 / SERVO_HZ, clock.monotonic_s() - 1.0 / SERVO_HZ)
            await asyncio.sleep(due_s - clock.monotonic_s())
            now_s = clock.monotonic_s()
            self._hardware.advance(now_s, now_s - last_s)
            last_s = now_s
            line = json.dumps(self._hardware.reading(now_s)).encode() + b"\n"
            for writer in self._clients:
                if writer.transport.get_write_buffer_size() < _MOST_WAITING_BYTES:
                    writer.write(line)

    async def _client(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if clock.monotonic_s() < self._cut_until_s:
            writer.close()
            return
        self._clients.add(writer)
        with contextlib.suppress(
            ConnectionError, ValueError
        ):  # whoever goes, or sends what is no JSON, is gone
            while line := await reader.readline():
                self._hear(json.loads(line), writer)
        self._clients.discard(writer)
        writer.close()

    def _hear(self, message: dict[str, Any], writer: asyncio.StreamWriter) -> None:
        if "fault" in message:
            self._hardware.fault = HardwareFault(message["fault"])
        elif "cut_s" in message:
            self._cut_until_s = clock.monotonic_s() + float(message["cut_s"])
            for other in self._clients - {writer}:
                other.transport.abort()
        elif "history_s" in message:
            since_s = clock.monotonic_s() - float(message["history_s"])
            kept = [(one.at_s, *one.joints) for one in self._hardware.history if one.at_s >= since_s]
            writer.write(json.dumps({"history": kept}).encode() + b"\n")
        else:
            self._hardware.hear(message, clock.monotonic_s())


@click.command()
@click.option("--port", default=9000, show_default=True, help="0: a free one, which is printed.")
@click.option("--joints", default=_HOME_RAD, show_default=True, help="Where it stands, radians.")
@click.option("--seed", default=0, show_default=True, help="Of its delays, its noise and its clock.")
def main(port: int, joints: str, seed: int) -> None:
    """Simulate an arm's hardware behind a socket of this machine."""
    go_first()  # hardware waits for no processor; where that is refused, the driver says so
    hardware = ArmHardware([float(value) for value in joints.split(",")], seed)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(HardwareServer(hardware).serve(port))


if __name__ == "__main__":
    main()
