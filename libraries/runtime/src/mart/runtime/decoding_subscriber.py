"""Pass on bus messages of one kind; garbage is counted, logged once a second at most, and otherwise ignored."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Generic, TypeVar

from google.protobuf.message import Message

from mart.protocol import clock
from mart.protocol.errors import InvalidInput
from mart.protocol.received import decode_received, require_room
from mart.runtime.bus.base import Sample
from mart.runtime.rate_limit import RateLimit

_log = logging.getLogger(__name__)

M = TypeVar("M", bound=Message)


class DecodingSubscriber(Generic[M]):
    """Decode each sample and hand it to `take`, which may raise InvalidInput for one that makes no sense."""

    def __init__(self, kind: type[M], take: Callable[[M], None]) -> None:
        self.garbage = 0
        self._kind = kind
        self._take = take
        self._log_limit = RateLimit(1)

    def __call__(self, sample: Sample) -> None:
        try:
            message = decode_received(self._kind, sample.payload)
            require_room(message, sample.key)
            self._take(message)
        except Exception as error:  # noqa: BLE001 - logged whole; the next message must still be taken
            self._count(sample.key, error)

    def _count(self, key: str, error: Exception) -> None:
        self.garbage += 1
        if self._log_limit.allows(clock.monotonic_s()):
            expected = isinstance(error, InvalidInput)
            trace = None if expected else error
            _log.warning("%s: %s (%d so far)", key, error, self.garbage, exc_info=trace)
