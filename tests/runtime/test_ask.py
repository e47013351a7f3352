"""Asking a service: a reply is a message, an error in it is raised, silence and rubbish are errors too."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator

import pytest

from mart.protocol import codec, keys
from mart.protocol.errors import Conflict, InvalidInput, Unavailable
from mart.protocol.messages import RoomReply, Seat, SeatRequest, error_message
from mart.runtime.ask import ask, ask_async
from mart.runtime.bus import Bus, Request
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork

TOPIC = keys.seat("room-1")
TAKEN = codec.encode(RoomReply(error=error_message(Conflict("The seat is taken."))))


@contextlib.contextmanager
def answering(payload: bytes) -> Iterator[Bus]:
    bus = MemoryNetwork().connect()

    def reply(request: Request) -> None:
        codec.decode(SeatRequest, request.payload)
        request.reply(payload)

    with contextlib.closing(bus.serve(TOPIC, reply)):
        yield bus


def test_a_reply_comes_back_decoded() -> None:
    with answering(codec.encode(RoomReply(seat=Seat(arm="arm1")))) as bus:
        assert ask(bus, TOPIC, SeatRequest(), RoomReply, 1.0).seat.arm == "arm1"


def test_an_error_in_the_reply_is_raised_as_what_it_is() -> None:
    with answering(TAKEN) as bus, pytest.raises(Conflict):
        ask(bus, TOPIC, SeatRequest(), RoomReply, 1.0)


def test_a_reply_that_is_none_is_refused() -> None:
    with answering(b"\xff\xff") as bus, pytest.raises(InvalidInput):
        ask(bus, TOPIC, SeatRequest(), RoomReply, 1.0)
    with answering(b"\x00" * 9) as bus, pytest.raises(InvalidInput):
        ask(bus, TOPIC, SeatRequest(), RoomReply, 1.0, limit_bytes=8)


def test_nobody_answers() -> None:
    with pytest.raises(Unavailable):
        ask(MemoryNetwork().connect(), TOPIC, SeatRequest(), RoomReply, 0.1)


def test_the_same_on_an_event_loop() -> None:
    async def both(bus: Bus) -> RoomReply:
        return await ask_async(
            AsyncBus(bus, asyncio.get_running_loop()), TOPIC, SeatRequest(), RoomReply, 1.0
        )

    with answering(codec.encode(RoomReply(seat=Seat(arm="arm1")))) as bus:
        assert asyncio.run(both(bus)).seat.arm == "arm1"
    with answering(TAKEN) as bus, pytest.raises(Conflict):
        asyncio.run(both(bus))
