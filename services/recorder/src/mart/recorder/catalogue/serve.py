"""Serve the catalogue on the bus, in a process of its own: whoever browses never costs a recording a message."""

from __future__ import annotations

import contextlib
import os

from mart.protocol import keys
from mart.protocol.messages import CatalogueReply, CatalogueRequest
from mart.protocol.queryables import CATALOGUE
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.quality_measurer import QualityMeasurer
from mart.recorder.settings import RecorderSettings
from mart.runtime.bus import Request
from mart.runtime.service import announced, connected
from mart.runtime.serving import BoundedInbox, RequestAnswerer

_MAX_WAITING = 256
_STOP_CHECK_S = 0.5
_NICENESS = 10  # rooms and recordings go first


def serve_catalogue(settings: RecorderSettings, name: str) -> None:
    """Answer questions until the process is asked to stop."""
    os.nice(_NICENESS)
    inbox = BoundedInbox[Request](_MAX_WAITING)
    quality = QualityMeasurer()
    handlers = CatalogueHandlers(settings.episodes_dir, settings.data_dir / "logs" / "render.log", quality)
    answerer = catalogue_answerer(handlers)
    with connected(settings, ServiceKind.CATALOGUE, name) as service, contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.closing(handlers))
        stack.enter_context(contextlib.closing(quality))
        quality.start()
        stack.enter_context(contextlib.closing(service.bus.serve(keys.catalogue(name), inbox.put)))
        stack.enter_context(announced(service))
        while not service.stop.is_set():
            request = inbox.take(_STOP_CHECK_S)
            if request is not None:
                answerer.respond(request)


def catalogue_answerer(handlers: CatalogueHandlers) -> RequestAnswerer[CatalogueRequest, CatalogueReply]:
    """Return what answers encoded requests with `handlers`."""
    return RequestAnswerer(CATALOGUE, handlers.answer)
