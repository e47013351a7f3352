from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator

import pytest

from mart.protocol import codec, keys
from mart.protocol.errors import Conflict, InvalidInput, Unavailable
from mart.protocol.messages import RoomReply, RoomsRequest, RoomStatus, error_message
from mart.runtime.ask_async import ask_async
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Request
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork

pytestmark = pytest.mark.anyio

TOPIC = keys.rooms("platform-1")


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def bus() -> Iterator[MemoryBus]:
    with MemoryNetwork().connect() as bus:
        yield bus


async def ask(bus: MemoryBus, max_reply_bytes: int = 1024) -> RoomReply:
    aio = AsyncBus(bus, asyncio.get_running_loop())
    return await ask_async(
        aio, TOPIC, RoomsRequest(), RoomReply, timeout_s=1.0, max_reply_bytes=max_reply_bytes
    )


@contextlib.contextmanager
def answering(bus: MemoryBus, payload: bytes) -> Iterator[None]:
    def answer(request: Request) -> None:
        request.reply(payload)

    with contextlib.closing(bus.serve(TOPIC, answer)):
        yield


async def test_a_reply_comes_back_decoded(bus: MemoryBus) -> None:
    with answering(bus, codec.encode(RoomReply(status=RoomStatus(room="room-2")))):
        assert (await ask(bus)).status.room == "room-2"


async def test_what_the_other_side_reports_is_raised(bus: MemoryBus) -> None:
    with (
        answering(bus, codec.encode(RoomReply(error=error_message(Conflict("Two are open."))))),
        pytest.raises(Conflict),
    ):
        await ask(bus)


@pytest.mark.parametrize("payload", [b"\xff" * 40, bytes(2000)])
async def test_what_is_no_reply_is_told(bus: MemoryBus, payload: bytes) -> None:
    with answering(bus, payload), pytest.raises(InvalidInput):
        await ask(bus)


async def test_where_nobody_answers_that_is_told(bus: MemoryBus) -> None:
    with pytest.raises(Unavailable):
        await ask(bus)
