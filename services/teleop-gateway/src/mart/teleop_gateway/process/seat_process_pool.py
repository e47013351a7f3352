"""Start processes of seats ahead of time, assign, watch and end them."""

from __future__ import annotations

import asyncio
import contextlib
import sys

from mart.protocol.errors import Unavailable
from mart.teleop_gateway.process.seat_process_protocol import WARM, encode_assignment
from mart.teleop_gateway.served_seats import SeatAddress

_MODULE = "mart.teleop_gateway.process.seat_process"
_END_TIMEOUT_S = 3.0


class SeatProcess:
    """Hold one process. It ends by itself when its standard input closes, so also when this process is killed."""

    def __init__(
        self, process: asyncio.subprocess.Process, stdin: asyncio.StreamWriter, stdout: asyncio.StreamReader
    ) -> None:
        self._process, self._stdin, self._stdout = process, stdin, stdout

    @classmethod
    async def start(cls) -> SeatProcess:
        """Start a process; it warms up by itself."""
        pipe = asyncio.subprocess.PIPE
        process = await asyncio.create_subprocess_exec(sys.executable, "-m", _MODULE, stdin=pipe, stdout=pipe)
        assert process.stdin is not None
        assert process.stdout is not None
        return cls(process, process.stdin, process.stdout)

    @property
    def pid(self) -> int:
        """Return the process's id."""
        return self._process.pid

    async def assign(self, seat: SeatAddress) -> None:
        """Wait until it is warm, then give it its seat; raises Unavailable where it died before."""
        if await self._stdout.readline() != WARM:
            status = await self._process.wait()
            raise Unavailable(
                f"A seat process ended with status {status} before it was ready; its log says why."
            )
        self._stdin.write(encode_assignment(seat))

    async def ended(self) -> int:
        """Return its exit status, once it has one."""
        return await self._process.wait()

    async def end(self) -> None:
        """End it: orderly if it will, by force if not."""
        self._stdin.close()
        try:
            async with asyncio.timeout(_END_TIMEOUT_S):
                await self._process.wait()
        except TimeoutError:
            with contextlib.suppress(ProcessLookupError):  # it ended just now
                self._process.kill()
            await self._process.wait()


class SeatProcessPool:
    """Keep one warm process ahead of the next seat."""

    def __init__(self) -> None:
        self._next: asyncio.Task[SeatProcess] | None = None

    def prepare(self) -> None:
        """Start the next process, if there is none."""
        if self._next is None:
            self._next = asyncio.create_task(SeatProcess.start())

    async def take(self) -> SeatProcess:
        """Return the process that was prepared; call `prepare` again once it has its seat."""
        self.prepare()
        assert self._next is not None
        ready, self._next = self._next, None
        return await ready

    async def close(self) -> None:
        """End the process that nobody took."""
        if self._next is not None:
            await (await self._next).end()
