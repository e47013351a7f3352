"""Answer what is asked on the bus: whatever is asked, and whatever goes wrong over it, the service lives on.

Every service answers through here. What is refused says so in its own words; what a service failed at is logged whole
and told as a ServiceFault, so that one request never ends a service that others need.
"""

from __future__ import annotations

import logging
import queue
from collections.abc import Awaitable, Callable
from contextlib import AbstractContextManager
from typing import Any, Generic, TypeVar

from google.protobuf.message import Message
from prometheus_client import Counter, Summary

from mart.protocol import clock, codec
from mart.protocol.errors import MartError, ServiceFault
from mart.protocol.messages import error_message
from mart.protocol.queryables import Queryable
from mart.protocol.received import decode_received
from mart.runtime.bus.base import Request
from mart.runtime.metrics import REGISTRY
from mart.runtime.rate_limit import RateLimit

_log = logging.getLogger(__name__)

Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)
T = TypeVar("T")

OnRefused = Callable[[MartError], None]

REQUEST = Summary(
    "mart_request_seconds",
    "What it took to answer a request of the bus.",
    ("queryable",),
    registry=REGISTRY,
)
FAILED_REQUESTS = Counter(
    "mart_failed_requests",
    "Requests of the bus that were answered by an error: refused, or failed at.",
    ("queryable", "error"),
    registry=REGISTRY,
)


class RequestAnswerer(Generic[Q, R]):
    """Decode a request, let `handle` answer it, encode the reply; every exception becomes a reply that says it.

    `on_refused` is told of each request that was answered by an error of the tree.
    """

    def __init__(
        self, queryable: Queryable[Q, R], handle: Callable[[Q], R], on_refused: OnRefused | None = None
    ) -> None:
        self._handle = handle
        self._edge = _Edge(queryable, on_refused)

    def __call__(self, payload: bytes) -> bytes:
        """Return the encoded reply to an encoded request. Raises nothing."""
        try:
            with self._edge.timed():
                return codec.encode(self._handle(self._edge.decode(payload)))
        except Exception as error:  # noqa: BLE001 - told and logged; the next request must be answered
            return self._edge.failed(error)

    def respond(self, request: Request) -> None:
        """Answer a request of the bus. Raises nothing."""
        send_reply(request, self(request.payload))


class AsyncRequestAnswerer(Generic[Q, R]):
    """Do the same on an event loop."""

    def __init__(
        self,
        queryable: Queryable[Q, R],
        handle: Callable[[Q], Awaitable[R]],
        on_refused: OnRefused | None = None,
    ) -> None:
        self._handle = handle
        self._edge = _Edge(queryable, on_refused)

    async def __call__(self, payload: bytes) -> bytes:
        """Return the encoded reply to an encoded request. Raises nothing but a cancellation."""
        try:
            with self._edge.timed():
                return codec.encode(await self._handle(self._edge.decode(payload)))
        except Exception as error:  # noqa: BLE001 - told and logged; the next request must be answered
            return self._edge.failed(error)


class BoundedInbox(Generic[T]):
    """Hold what waits for one thread. What is one too many is left: whoever asked hears nothing, and asks again."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._queue: queue.SimpleQueue[T] = queue.SimpleQueue()

    def put(self, item: T) -> None:
        """Add an item to the end, unless `most` wait. For any thread; never waits."""
        if self._queue.qsize() < self._most:
            self._queue.put(item)

    def put_always(self, item: T) -> None:
        """Add what this process itself has to say, of which there is a bounded number. For any thread."""
        self._queue.put(item)

    def take(self, timeout_s: float) -> T | None:
        """Return the first item; None where nothing came within `timeout_s`."""
        try:
            return self._queue.get(timeout=timeout_s)
        except queue.Empty:
            return None


def send_reply(request: Request, payload: bytes) -> None:
    """Answer a request with `payload`; where its asker cannot be reached any more, that is logged. Raises nothing."""
    try:
        request.reply(payload)
    except Exception as error:  # noqa: BLE001 - the bus's own errors; whoever asked has gone or asks again
        _log.warning("An answer on %s could not be sent: %s", request.key, error)


class _Edge(Generic[Q, R]):
    def __init__(self, queryable: Queryable[Q, R], on_refused: OnRefused | None) -> None:
        self._queryable, self._on_refused = queryable, on_refused
        self._log_limit = RateLimit(1)
        self._took = REQUEST.labels(queryable.name)

    def timed(self) -> AbstractContextManager[object]:
        """Measure what the block takes."""
        return self._took.time()

    def decode(self, payload: bytes) -> Q:
        return decode_received(self._queryable.request_type, payload, self._queryable.limit_bytes)

    def failed(self, error: Exception) -> bytes:
        if isinstance(error, MartError):
            told = error
            if self._on_refused is not None:
                self._on_refused(error)
        else:
            told = ServiceFault(
                f"Something went wrong over this request ({type(error).__name__} in {self._queryable.name}); "
                "the service goes on, and its log says what it was."
            )
            if self._log_limit.allows(clock.monotonic_s()):
                _log.error("A request of %s failed", self._queryable.name, exc_info=error)
        FAILED_REQUESTS.labels(self._queryable.name, type(told).__name__).inc()
        reply: Any = self._queryable.reply_type
        return codec.encode(reply(error=error_message(told)))
