"""Answer requests one at a time, and read the folders that some of them need on a thread beside."""

from __future__ import annotations

import logging
import queue
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from mart.protocol import codec
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import TrainerReply, TrainerRequest, error_message
from mart.runtime.bus import Request
from mart.trainer.jobs.service.handlers import TrainerHandlers

_log = logging.getLogger(__name__)

MAX_REQUEST_BYTES = 64 * 1024
MAX_WAITING = 64

Inbox = queue.SimpleQueue[
    Callable[[], object]
]  # what the trainer's one thread has to do, in the order it came


class RequestServer:
    """Answer every request, with an error where it cannot be done; no request ends the trainer.

    What comes over the bus is put into the inbox, and done by whoever takes from it.
    """

    def __init__(self, handlers: TrainerHandlers, inbox: Inbox) -> None:
        self._handlers = handlers
        self._inbox = inbox
        self._reader = ThreadPoolExecutor(1, "folders")

    def on_request(self, request: Request) -> None:
        """Put a request into the inbox; called on a thread of the bus. Where too many wait, it is refused at once."""
        if self._inbox.qsize() < MAX_WAITING:
            self._inbox.put(lambda: _answer(request, lambda: self._begin(request)))
        else:
            _answer(request, _refuse)

    def close(self) -> None:
        """Return once no folder is being read any more; requests that still wait for one are not answered."""
        self._reader.shutdown(cancel_futures=True)

    def _begin(self, request: Request) -> TrainerReply | None:
        """Return the reply; None where a folder has to be read first."""
        asked = codec.decode(TrainerRequest, request.payload, MAX_REQUEST_BYTES)
        if not self._handlers.reads_folders(asked):
            return self._handlers.prepare(asked)()
        self._reader.submit(_answer, request, lambda: self._read(request, asked))
        return None

    def _read(self, request: Request, asked: TrainerRequest) -> None:
        """Read on this thread, and leave the rest, which touches jobs, to the one that the inbox belongs to."""
        finish = self._handlers.prepare(asked)
        self._inbox.put(lambda: _answer(request, finish))


def _answer(request: Request, do: Callable[[], TrainerReply | None]) -> None:
    """Reply with what `do` returns or with the error that it raises; None is replied to later."""
    try:
        reply = do()
    except MartError as error:
        reply = TrainerReply(error=error_message(error))
    except Exception:  # noqa: BLE001 - logged whole; what one request trips over ends no other
        _log.exception("A request could not be answered")
        failed = MartError("The trainer failed at this; its log tells more.")
        reply = TrainerReply(error=error_message(failed))
    if reply is not None:
        request.reply(codec.encode(reply))


def _refuse() -> TrainerReply:
    raise Unavailable(f"{MAX_WAITING} requests wait for the trainer already; try again in a moment.")
