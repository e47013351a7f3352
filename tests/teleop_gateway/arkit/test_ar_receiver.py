"""The port that the app speaks to: one phone at a time, no page, no flood; and the arm goes where the phone goes."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable

import numpy as np
import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from mart.protocol.errors import Unavailable
from mart.protocol.tokens import Role
from mart.teleop_gateway.arkit import ar_receiver
from mart.teleop_gateway.arkit.ar_phone import ARPhone
from mart.teleop_gateway.arkit.ar_receiver import MAX_MESSAGES_PER_S, ARReceiver
from mart.teleop_gateway.arkit.drive import connection_of
from tests.teleop_gateway.arkit.ar_app import app_message, camera_at
from tests.teleop_gateway.browser import in_background
from tests.teleop_gateway.room import OnSeat, SeatUnderTest

pytestmark = pytest.mark.system

HERE = "127.0.0.1"


@contextlib.asynccontextmanager
async def listening(receiver: ARReceiver) -> AsyncIterator[int]:
    async with await receiver.listen(HERE, 0) as server:
        yield next(iter(server.sockets)).getsockname()[1]


def app(port: int, origin: str | None = None) -> connect:
    return connect(f"ws://{HERE}:{port}", origin=origin, proxy=None)  # type: ignore[arg-type]


async def until(holds: Callable[[], bool]) -> None:
    async with asyncio.timeout(20):
        while not holds():  # noqa: ASYNC110  (of what has no event)
            await asyncio.sleep(0.01)


def test_the_newest_message_counts_and_what_is_none_does_not() -> None:
    async def run() -> None:
        receiver = ARReceiver()
        async with listening(receiver) as port, app(port) as phone:
            await phone.send("hello?")
            for step in range(10):
                await phone.send(app_message(camera_at((step / 10, 0, 0))))
            await until(lambda: receiver.newest is not None)
            await until(lambda: receiver.newest.pose_phone_in_session.position[0] == 0.9)  # type: ignore[union-attr]
            await phone.close()
            await until(lambda: receiver.newest is None)  # a phone that is gone says nothing any more

    asyncio.run(run())


def test_pages_and_a_second_phone_are_refused_and_a_silent_one_is_replaced(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def run() -> None:
        receiver = ARReceiver()
        async with listening(receiver) as port:
            with pytest.raises(InvalidStatus, match="403"):
                async with app(port, origin="https://example.org"):
                    pass
            async with app(port) as first:
                with pytest.raises(InvalidStatus, match="409"):
                    async with app(port):
                        pass
                monkeypatch.setattr(ar_receiver, "SPEAKS_WITHIN_S", 0.0)
                async with app(port) as second:
                    with pytest.raises(ConnectionClosed):
                        await first.recv()
                    await second.send(app_message(camera_at((0, 0, 0))))
                    await until(lambda: receiver.newest is not None)

    asyncio.run(run())


def test_a_flood_ends_the_connection() -> None:
    async def flood(phone: ClientConnection) -> None:
        message = app_message(camera_at((0, 0, 0)))
        for _ in range(20 * MAX_MESSAGES_PER_S):
            await phone.send(message)
        await phone.recv()

    async def run() -> None:
        async with listening(ARReceiver()) as port, app(port) as phone:
            with pytest.raises(ConnectionClosed, match="1008"):
                await flood(phone)

    asyncio.run(run())


def test_bytes_that_are_no_websocket_end_their_connection_and_bring_no_traceback(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def run() -> None:
        async with listening(ARReceiver()) as port:
            reader, writer = await asyncio.open_connection(HERE, port)
            writer.write(b"hello?\r\n\r\n")
            assert await asyncio.wait_for(reader.read(), 20) == b""
            writer.close()

    asyncio.run(run())
    assert [record for record in caplog.records if record.exc_info] == []


def test_a_port_that_is_taken_is_said_so() -> None:
    async def run() -> None:
        async with listening(ARReceiver()) as port:
            with pytest.raises(Unavailable):
                await ARReceiver().listen(HERE, port)

    asyncio.run(run())


async def raise_by(
    metres: float, sender: ClientConnection, engaged: Callable[[], bool], done: Callable[[], bool]
) -> None:
    """Press the button and lift the phone; press anew where frames were missing, as on a busy machine."""
    raised_m, sent = 0.0, 0
    while not done():
        pressed = engaged() or sent % 40 > 10
        raised_m = min(raised_m + 0.003, metres) if engaged() else 0.0
        await sender.send(app_message(camera_at((0, raised_m, 0)), button=pressed))
        sent += 1
        await asyncio.sleep(0.02)


def test_the_tool_goes_where_the_phone_goes(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        receiver, phone = ARReceiver(), ARPhone(seat_epoch=1)
        start = seat.room.world.tool_pose_in_base("arm0").position

        def height_m() -> float:
            return float((seat.room.world.tool_pose_in_base("arm0").position - start)[2])

        connection = connection_of("arm0", receiver, phone, seat.exchange(Role.PHONE))
        async with listening(receiver) as port, app(port) as sender, in_background(connection.run()):
            await until(lambda: bool(phone._told))
            async with asyncio.timeout(30):
                await raise_by(
                    0.1, sender, lambda: bool(phone._told.get("engaged")), lambda: height_m() > 0.08
                )
        moved = seat.room.world.tool_pose_in_base("arm0").position - start
        assert moved[2] > 0.07
        assert np.linalg.norm(moved[:2]) < 0.02

    on_seat(body)
