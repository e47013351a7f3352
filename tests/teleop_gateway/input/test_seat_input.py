"""A seat's input follows its holder: whose token is newer than the last status waits for it, and is not refused."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from mart.protocol import clock, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    BARRIER_PHASE_STOPPED,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    ArmState,
    BarrierPhase,
    Command,
    Operator,
    RoomStatus,
)
from mart.protocol.messages import Seat as SeatMessage
from mart.protocol.pose import Pose
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.teleop_gateway.input.driving import InputDevice
from mart.teleop_gateway.input.frame_validator import LetGo
from mart.teleop_gateway.input.seat_input import SeatInput
from mart.teleop_gateway.served_seats import SeatAddress
from tests.teleop_gateway.input.strategies import phone_frame

SEAT = SeatAddress("room-1", "arm0")


class InputUnderTest:
    """An input on a bus in memory, and what it does."""

    def __init__(self) -> None:
        self.made: list[Command] = []
        self.sent: list[bytes] = []
        self.holders = 0
        bus = MemoryNetwork().connect()
        bus.subscribe(keys.command(SEAT.room, SEAT.arm).key, lambda sample: self.sent.append(sample.payload))
        self.input = SeatInput(
            AsyncBus(bus, asyncio.get_running_loop()),
            SEAT,
            hand_scale=1.0,
            on_command=self.made.append,
            on_new_holder=self._count,
        )

    def tell(self, epoch: int, operator: int = OPERATOR_HUMAN, barrier: int = BARRIER_PHASE_RUNNING) -> None:
        seat = SeatMessage(arm=SEAT.arm, operator=Operator.Name(operator), epoch=epoch)
        phase = BarrierPhase.Name(barrier)
        self.input.on_status(RoomStatus(room=SEAT.room, seats=[seat], barrier=phase))

    def _count(self) -> None:
        self.holders += 1


def on_input(body: Callable[[InputUnderTest], Awaitable[None]]) -> None:
    async def main() -> None:
        async with asyncio.timeout(30):
            await body(InputUnderTest())

    asyncio.run(main())


@pytest.mark.parametrize(
    ("barrier", "reason"),
    [
        (BARRIER_PHASE_RUNNING, None),
        (BARRIER_PHASE_STALLED, None),  # for a moment
        (BARRIER_PHASE_PAUSED, LetGo.PAUSE),
        (BARRIER_PHASE_STOPPED, LetGo.STOP),
    ],
)
def test_hands_count_while_the_world_runs(barrier: int, reason: LetGo | None) -> None:
    async def body(seat: InputUnderTest) -> None:
        seat.input.on_camera_azimuth(0.0)
        seat.tell(epoch=1)
        driving = await seat.input.await_driving(1, timeout_s=20.0)
        seat.tell(epoch=1, barrier=barrier)
        assert driving.held_by_room is reason
        seat.tell(epoch=1)
        assert driving.held_by_room is None

    on_input(body)


def test_a_token_newer_than_the_last_status_waits_for_the_next_one() -> None:
    async def body(seat: InputUnderTest) -> None:
        seat.input.on_camera_azimuth(0.0)
        seat.tell(epoch=1)
        waiting = asyncio.create_task(seat.input.await_driving(3, timeout_s=20.0))
        await asyncio.sleep(0)
        seat.tell(epoch=2)
        await asyncio.sleep(0)
        assert not waiting.done()
        seat.tell(epoch=3)
        assert (await waiting).seat_epoch == 3

    on_input(body)


def test_who_waits_in_vain_gets_the_holder_that_is_known() -> None:
    async def body(seat: InputUnderTest) -> None:
        with pytest.raises(Unavailable):
            await seat.input.await_driving(1, timeout_s=0.01)
        seat.tell(epoch=1)  # and still nobody knows where the camera looks
        with pytest.raises(Unavailable):
            await seat.input.await_driving(1, timeout_s=0.01)
        seat.input.on_camera_azimuth(0.0)
        assert (await seat.input.await_driving(9, timeout_s=0.01)).seat_epoch == 1

    on_input(body)


def test_a_new_holder_begins_anew_and_the_same_one_goes_on() -> None:
    async def body(seat: InputUnderTest) -> None:
        seat.input.on_camera_azimuth(0.0)
        seat.tell(epoch=1)
        first = seat.input.driving
        seat.tell(epoch=1)
        seat.input.on_camera_azimuth(1.0)
        assert seat.input.driving is first
        changes = seat.holders
        seat.tell(epoch=2)
        assert seat.input.driving is not first
        seat.tell(epoch=3, operator=OPERATOR_HOLD)
        assert seat.input.driving is None
        assert seat.holders == changes + 2

    on_input(body)


def test_frames_of_the_holder_alone_become_commands() -> None:
    async def body(seat: InputUnderTest) -> None:
        seat.input.connect(InputDevice.KEYBOARD)
        seat.input.receive(InputDevice.KEYBOARD, phone_frame(epoch=1).encode())  # nobody holds the seat
        seat.input.on_camera_azimuth(0.0)
        seat.tell(epoch=1)
        seat.input.on_state(ArmState(arm=SEAT.arm), Pose.identity(), 1, 0.0, was_reset=False)
        seat.input.connect(InputDevice.KEYBOARD)
        before_ns = clock.wall_ns()
        seat.input.receive(InputDevice.KEYBOARD, phone_frame(epoch=1).encode())
        seat.input.receive(InputDevice.KEYBOARD, phone_frame(epoch=2, sequence=9).encode())
        (command,) = seat.made
        assert len(seat.sent) == 1
        assert (command.arm, command.seat_epoch) == (SEAT.arm, 1)
        assert before_ns <= command.stamps.sent_ns <= clock.wall_ns()

    on_input(body)
