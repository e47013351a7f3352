"""Whatever a handler raises becomes an answer: for every kind of question that a service answers."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Any

import pytest
from google.protobuf.message import Message
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import codec
from mart.protocol.errors import Conflict, MartError
from mart.protocol.messages import RoomReply
from mart.protocol.queryables import QUERYABLES, SEAT, Queryable
from mart.runtime.serving import AsyncRequestAnswerer, BoundedInbox, RequestAnswerer, send_reply

_AnyQueryable = Queryable[Message, Message]
_FAILURES = (
    ValueError("embedded null byte"),
    OSError(36, "File name too long"),
    RecursionError(),
    KeyError("x"),
)

every_queryable = pytest.mark.parametrize("queryable", QUERYABLES, ids=lambda one: one.name)


def _failing(error: Exception) -> Callable[[Message], Any]:
    def handle(_request: Message) -> Any:
        raise error

    return handle


def _code(queryable: _AnyQueryable, reply: bytes) -> str:
    decoded = codec.decode(queryable.reply_type, reply)
    return decoded.error.code  # type: ignore[attr-defined]


@every_queryable
@pytest.mark.parametrize("error", _FAILURES, ids=lambda error: type(error).__name__)
def test_what_a_handler_fails_at_is_told_and_logged(
    queryable: _AnyQueryable, error: Exception, caplog: pytest.LogCaptureFixture
) -> None:
    answerer = RequestAnswerer(queryable, _failing(error))
    with caplog.at_level(logging.ERROR):
        assert _code(queryable, answerer(b"")) == "ServiceFault"
        assert _code(queryable, answerer(b"")) == "ServiceFault"  # it lives on
    (entry,) = caplog.records  # a flood of them does not flood the log
    assert entry.exc_info is not None


@every_queryable
def test_a_coroutine_that_fails_is_told_as_well(queryable: _AnyQueryable) -> None:
    async def handle(_request: Message) -> Message:
        raise ValueError

    assert _code(queryable, asyncio.run(AsyncRequestAnswerer(queryable, handle)(b""))) == "ServiceFault"


@every_queryable
@given(payload=st.binary(max_size=64))
def test_any_bytes_are_answered(queryable: _AnyQueryable, payload: bytes) -> None:
    answerer = RequestAnswerer(queryable, lambda _request: queryable.reply_type())
    assert _code(queryable, answerer(payload)) in ("", "InvalidInput")


def test_a_request_that_is_too_long_is_refused() -> None:
    answerer = RequestAnswerer(SEAT, lambda _request: RoomReply())
    assert codec.decode(RoomReply, answerer(bytes(SEAT.limit_bytes + 1))).error.code == "InvalidInput"


def test_what_is_refused_says_so_in_its_own_words() -> None:
    refused: list[MartError] = []
    answerer = RequestAnswerer(SEAT, _failing(Conflict("Ana sits there.")), refused.append)
    error = codec.decode(RoomReply, answerer(b"")).error
    assert (error.code, error.message) == ("Conflict", "Ana sits there.")
    assert [str(one) for one in refused] == ["Ana sits there."]


def test_an_answer_that_cannot_be_sent_ends_nothing() -> None:
    class Gone:
        key, payload = "mart/room-1/seat", b""

        def reply(self, payload: bytes) -> None:
            raise RuntimeError("the session is closed")

    send_reply(Gone(), b"")


def test_an_inbox_keeps_so_many_and_what_must_not_be_lost() -> None:
    inbox = BoundedInbox[int](2)
    for number in range(4):
        inbox.put(number)
    inbox.put_always(9)
    assert [inbox.take(0.0) for _ in range(4)] == [0, 1, 9, None]
