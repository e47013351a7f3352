"""Every seat has a process, also after one died or could not be started."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable

import pytest

from mart.protocol import codec, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import Event
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.process import seat_keeper
from mart.teleop_gateway.process.seat_keeper import SeatKeeper
from mart.teleop_gateway.process.seat_process_pool import SeatProcess
from mart.teleop_gateway.served_seats import SeatAddress

SEAT, OTHER = SeatAddress("room-1", "arm0"), SeatAddress("room-1", "arm1")
Seats = frozenset[SeatAddress]


class StubProcess:
    """A process that does as the test says."""

    pid = 4711

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self.seat: SeatAddress | None = None
        self._died: asyncio.Future[int] = asyncio.get_running_loop().create_future()

    async def assign(self, seat: SeatAddress) -> None:
        if self._machine.dead_on_arrival:
            self._machine.dead_on_arrival -= 1
            self._died.set_result(1)
            raise Unavailable("It ended before it was ready.")
        self.seat = seat
        self._machine.serving.append(self)
        self._machine.changed.set()

    async def ended(self) -> int:
        return await self._died

    async def end(self) -> None:
        if self in self._machine.serving:
            self._machine.serving.remove(self)
        self._machine.changed.set()

    def die(self, status: int) -> None:
        self._died.set_result(status)


class Machine:
    """What processes run on. The first `refused` cannot be started, the next `dead_on_arrival` end at once."""

    def __init__(self) -> None:
        self.refused = 0
        self.dead_on_arrival = 0
        self.serving: list[StubProcess] = []
        self.changed = asyncio.Event()
        self.notices: list[Event] = []
        network = MemoryNetwork()
        network.connect().subscribe(
            keys.event(SEAT.room).key, lambda sample: self.notices.append(codec.decode(Event, sample.payload))
        )
        self.keeper = SeatKeeper(AsyncBus(network.connect(), asyncio.get_running_loop()), "gateway-1")

    async def start(self) -> StubProcess:
        if self.refused:
            self.refused -= 1
            raise OSError("Resource temporarily unavailable")
        return StubProcess(self)

    async def serves(self, seats: Seats) -> list[StubProcess]:
        """Wait until exactly these seats are served."""
        while {process.seat for process in self.serving} != seats:
            self.changed.clear()
            await self.changed.wait()
        return list(self.serving)


Body = Callable[[Machine], Awaitable[None]]


@pytest.fixture
def on_machine(monkeypatch: pytest.MonkeyPatch) -> Callable[[Body], None]:
    monkeypatch.setattr(seat_keeper, "_RESTART_DELAY_S", 0.0)

    async def main(body: Body) -> None:
        machine = Machine()
        monkeypatch.setattr(SeatProcess, "start", machine.start)
        async with asyncio.timeout(20):
            await body(machine)
            await machine.keeper.close()
            assert machine.serving == []

    return lambda body: asyncio.run(main(body))


def test_seats_that_are_wanted_are_served_and_others_end(on_machine: Callable[[Body], None]) -> None:
    async def body(machine: Machine) -> None:
        machine.keeper.prepare()
        machine.keeper.keep(Seats({SEAT, OTHER}))
        await machine.serves(Seats({SEAT, OTHER}))
        machine.keeper.keep(Seats({OTHER}))
        await machine.serves(Seats({OTHER}))
        assert machine.notices == []

    on_machine(body)


def test_a_process_that_dies_is_told_of_and_followed_by_another(on_machine: Callable[[Body], None]) -> None:
    async def body(machine: Machine) -> None:
        machine.keeper.keep(Seats({SEAT}))
        (first,) = await machine.serves(Seats({SEAT}))
        machine.dead_on_arrival = 2
        first.die(-9)
        await machine.serves(Seats())
        (later,) = await machine.serves(Seats({SEAT}))
        assert later is not first
        assert [notice.notice.level for notice in machine.notices] == ["warning"] * 3

    on_machine(body)


@pytest.mark.parametrize(("crash_loop_s", "waits"), [(0.0, 0), (math.inf, 1)])
def test_only_after_a_process_that_died_young_is_there_a_wait(
    on_machine: Callable[[Body], None], monkeypatch: pytest.MonkeyPatch, crash_loop_s: float, waits: int
) -> None:
    waited_s: list[float] = []

    async def sleep(delay_s: float) -> None:
        waited_s.append(delay_s)

    async def body(machine: Machine) -> None:
        machine.keeper.keep(Seats({SEAT}))
        (first,) = await machine.serves(Seats({SEAT}))
        monkeypatch.setattr(asyncio, "sleep", sleep)
        first.die(-9)
        while not machine.serving or machine.serving == [first]:
            machine.changed.clear()
            await machine.changed.wait()
        assert len(waited_s) == waits

    monkeypatch.setattr(seat_keeper, "_CRASH_LOOP_S", crash_loop_s)
    on_machine(body)


def test_a_process_that_could_not_be_started_is_tried_again(
    on_machine: Callable[[Body], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By itself: no status of a room may be needed for it."""

    async def body(machine: Machine) -> None:
        machine.refused = 3
        machine.keeper.keep(Seats({SEAT}))
        await machine.serves(Seats({SEAT}))
        assert machine.refused == 0

    monkeypatch.setattr(seat_keeper, "_RESTART_DELAY_S", 0.01)
    on_machine(body)
