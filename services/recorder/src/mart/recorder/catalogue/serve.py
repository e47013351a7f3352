"""Serve the catalogue on the bus, in a process of its own: whoever browses never costs a recording a message."""

from __future__ import annotations

import contextlib
import os
import queue

from mart.protocol import codec, keys
from mart.protocol.errors import MartError
from mart.protocol.messages import CatalogueReply, CatalogueRequest, error_message
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.settings import RecorderSettings
from mart.runtime.bus import Request
from mart.runtime.service import announced, connected

_MAX_REQUEST_BYTES = 64 * 1024
_MAX_WAITING = 256
_STOP_CHECK_S = 0.5
_NICENESS = 10  # rooms and recordings go first


def serve_catalogue(settings: RecorderSettings, name: str) -> None:
    """Answer questions until the process is asked to stop."""
    os.nice(_NICENESS)
    inbox: queue.Queue[Request] = queue.Queue(_MAX_WAITING)
    handlers = CatalogueHandlers(settings.episodes_dir)

    def take(request: Request) -> None:
        with contextlib.suppress(queue.Full):  # whoever asks hears nothing in time, and asks again
            inbox.put_nowait(request)

    with connected(settings, ServiceKind.CATALOGUE, name) as service, contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.closing(service.bus.serve(keys.catalogue(name), take)))
        stack.enter_context(announced(service))
        while not service.stop.is_set():
            with contextlib.suppress(queue.Empty):
                request = inbox.get(timeout=_STOP_CHECK_S)
                request.reply(codec.encode(answer(handlers, request.payload)))


def answer(handlers: CatalogueHandlers, payload: bytes) -> CatalogueReply:
    """Answer one encoded request; an error becomes a reply that says it."""
    try:
        return handlers.answer(codec.decode(CatalogueRequest, payload, _MAX_REQUEST_BYTES))
    except MartError as error:
        return CatalogueReply(error=error_message(error))
