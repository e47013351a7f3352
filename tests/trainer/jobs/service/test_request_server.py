"""Requests are answered whatever happens, and folders are read beside."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from contextlib import closing
from typing import cast

import pytest

from mart.protocol import codec
from mart.protocol.errors import InvalidInput, MartError, Unavailable
from mart.protocol.messages import TrainerReply, TrainerRequest, raise_error
from mart.trainer.jobs.service.handlers import TrainerHandlers
from mart.trainer.jobs.service.request_server import MAX_READING, Inbox, RequestServer

LIST = TrainerRequest(list=TrainerRequest.List())
CHOICES = TrainerRequest(choices=TrainerRequest.Choices())


class Asked:
    def __init__(self, request: TrainerRequest | bytes) -> None:
        self.key = "mart/@live/trainer/trainer-1"
        self.payload = request if isinstance(request, bytes) else codec.encode(request)
        self.replies: list[TrainerReply] = []

    def reply(self, payload: bytes) -> None:
        self.replies.append(codec.decode(TrainerReply, payload))


class Handlers:
    def __init__(self, prepare: Callable[[TrainerRequest], Callable[[], TrainerReply]]) -> None:
        self.prepare = prepare

    def handle(self, request: TrainerRequest) -> TrainerReply:
        return self.prepare(request)()

    def reads_folders(self, request: TrainerRequest) -> bool:
        return request.WhichOneof("what") == "choices"


def serving(
    prepare: Callable[[TrainerRequest], Callable[[], TrainerReply]],
) -> tuple[RequestServer, Inbox]:
    inbox = Inbox(64)
    return RequestServer(cast("TrainerHandlers", Handlers(prepare)), inbox), inbox


def finish(inbox: Inbox) -> None:
    """What was read for is done, as by the trainer's thread."""
    item = inbox.take(30.0)
    assert callable(item)
    item()


def answered(server: RequestServer, inbox: Inbox, asked: Asked) -> TrainerReply:
    server.take(asked)
    if not asked.replies:
        finish(inbox)
    (reply,) = asked.replies
    return reply


@pytest.mark.parametrize("error", [ValueError("embedded null byte"), OSError(36, "File name too long")])
@pytest.mark.parametrize("request_", [LIST, CHOICES])
@pytest.mark.parametrize("late", [False, True])
def test_whatever_a_request_trips_over_is_an_answer(
    error: Exception, request_: TrainerRequest, late: bool
) -> None:
    def fail() -> TrainerReply:
        raise error

    def prepare(_: TrainerRequest) -> Callable[[], TrainerReply]:
        return fail if late else fail()  # type: ignore[return-value]

    server, inbox = serving(prepare)
    with closing(server):
        reply = answered(server, inbox, Asked(request_))
    with pytest.raises(MartError) as told:
        raise_error(reply.error)
    assert str(error) not in str(told.value)


def test_what_is_no_request_is_refused_in_words() -> None:
    server, inbox = serving(lambda _: TrainerReply)
    with closing(server), pytest.raises(InvalidInput):
        raise_error(answered(server, inbox, Asked(b"\xff" * 9)).error)


def test_others_are_answered_while_a_folder_is_read() -> None:
    going: queue.SimpleQueue[None] = queue.SimpleQueue()

    def prepare(request: TrainerRequest) -> Callable[[], TrainerReply]:
        if request.HasField("choices"):
            going.get()
        return TrainerReply

    server, inbox = serving(prepare)
    with closing(server):
        slow = Asked(CHOICES)
        server.take(slow)
        assert not answered(server, inbox, Asked(LIST)).error.code
        assert not slow.replies
        going.put(None)
        finish(inbox)
    assert len(slow.replies) == 1


def test_more_than_can_be_read_for_are_refused_at_once() -> None:
    going = threading.Event()

    def prepare(_: TrainerRequest) -> Callable[[], TrainerReply]:
        going.wait(30)
        return TrainerReply

    server, _inbox = serving(prepare)
    with closing(server):
        for _ in range(MAX_READING):
            server.take(Asked(CHOICES))
        late = Asked(CHOICES)
        server.take(late)
        going.set()
    with pytest.raises(Unavailable):
        raise_error(late.replies[0].error)
