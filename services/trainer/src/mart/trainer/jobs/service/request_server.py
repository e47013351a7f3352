"""Answer requests one at a time, and read the folders that some of them need on a thread beside."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from mart.protocol import codec
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import TrainerReply, TrainerRequest
from mart.protocol.queryables import TRAINING
from mart.runtime.bus import Request
from mart.runtime.serving import BoundedInbox, RequestAnswerer
from mart.trainer.jobs.executors.executor import JobEnded
from mart.trainer.jobs.service.handlers import TrainerHandlers

MAX_READING = 16

Inbox = BoundedInbox[Request | JobEnded | Callable[[], None]]  # what the trainer's one thread has to do


class RequestServer:
    """Answer every request on the thread that takes from the inbox. For that thread, but for what it says itself."""

    def __init__(self, handlers: TrainerHandlers, inbox: Inbox) -> None:
        self._handlers = handlers
        self._inbox = inbox
        self._answerer = RequestAnswerer(TRAINING, handlers.handle)
        self._reader = ThreadPoolExecutor(1, "folders")
        self._free = threading.Semaphore(MAX_READING)

    def take(self, request: Request) -> None:
        """Answer a request, or begin to read what it needs: the rest comes through the inbox."""
        asked = _reading(request, self._handlers)
        if asked is None:
            self._answerer.respond(request)
        elif self._free.acquire(blocking=False):
            self._reader.submit(self._read, request, asked)
        else:
            busy = Unavailable(
                f"{MAX_READING} requests that read folders wait already; try again in a moment."
            )
            _answer(request, _failing(busy))

    def close(self) -> None:
        """Return once no folder is being read any more; requests that still wait for one are not answered."""
        self._reader.shutdown(cancel_futures=True)

    def _read(self, request: Request, asked: TrainerRequest) -> None:
        """Read on this thread, and leave the rest, which touches jobs, to the one that the inbox belongs to."""
        try:
            finish = self._handlers.prepare(asked)
        except Exception as error:  # noqa: BLE001 - told and logged where the request is answered
            finish = _failing(error)
        finally:
            self._free.release()
        self._inbox.put_always(lambda: _answer(request, finish))


def _reading(request: Request, handlers: TrainerHandlers) -> TrainerRequest | None:
    """Return what is asked where that reads folders; None for anything else, also for what is no request."""
    try:
        asked = codec.decode(TrainerRequest, request.payload, TRAINING.limit_bytes)
    except MartError:
        return None
    return asked if handlers.reads_folders(asked) else None


def _answer(request: Request, finish: Callable[[], TrainerReply]) -> None:
    RequestAnswerer(TRAINING, lambda _: finish()).respond(request)


def _failing(error: Exception) -> Callable[[], TrainerReply]:
    def fail() -> TrainerReply:
        raise error

    return fail
