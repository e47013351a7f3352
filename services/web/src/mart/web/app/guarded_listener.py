"""Hold open connections to the limits of a `ConnectionTable`, from the moment they are accepted.

A server's own limits begin with a request, and a connection that never gets so far (no TLS handshake, half a head)
costs a descriptor as any other. So the listener itself counts what it accepts.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import functools
import logging
import resource
import socket
from collections.abc import Callable
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from mart.protocol import clock
from mart.runtime.rate_limit import RateLimit
from mart.web.access.connection_table import ConnectionTable, Peer
from mart.web.access.plain_http import is_plain_http, redirection

_log = logging.getLogger(__name__)

TAKEN_WITHIN_S = 30.0  # a piece of an answer, by whoever asked
_LOOK_EVERY_S = 1.0
_MAX_FILES = 65_536
_KEPT_FILES = 256  # descriptors for everything but connections
_NO_MORE_FILES = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)


class GuardedListener(socket.socket):
    """A listening socket that ends connections which are too many, or ask nothing for too long."""

    def __init__(self, listener: socket.socket, table: ConnectionTable) -> None:
        """Take `listener` over: it is closed with this one."""
        super().__init__(listener.family, listener.type, listener.proto, fileno=listener.detach())
        self._table = table
        self._connections: dict[Peer, _Accepted] = {}

    def accept(self) -> tuple[socket.socket, Any]:
        """Return the next connection that is let in; raises BlockingIOError where there is none."""
        while True:
            accepted, address = super().accept()
            peer: Peer = (str(address[0]), int(address[1]))
            ended = self._table.open(peer, clock.monotonic_s())
            if ended == peer:
                self._table.close(peer)
                accepted.close()
                continue
            if ended is not None:
                self._end(ended)
            self._connections[peer] = _Accepted(accepted, functools.partial(self._on_close, peer))
            return self._connections[peer], address

    async def keep_ending(self) -> None:
        """End what has asked nothing for too long, once a second, until cancelled."""
        while True:
            await asyncio.sleep(_LOOK_EVERY_S)
            for peer in self._table.overdue(clock.monotonic_s()):
                self._end(peer)

    def _end(self, peer: Peer) -> None:
        """Shut it down: whoever serves it finds its end and closes it."""
        self._table.close(peer)
        connection = self._connections.pop(peer, None)
        if connection is not None:
            with contextlib.suppress(OSError):  # it has just ended by itself
                connection.shutdown(socket.SHUT_RDWR)

    def _on_close(self, peer: Peer) -> None:
        self._table.close(peer)
        self._connections.pop(peer, None)


class _Accepted(socket.socket):
    """An accepted connection that tells when it is closed."""

    def __init__(self, accepted: socket.socket, on_close: Callable[[], None]) -> None:
        super().__init__(accepted.family, accepted.type, accepted.proto, fileno=accepted.detach())
        self._on_close: Callable[[], None] | None = on_close
        self._has_begun = False

    def recv_into(self, buffer: Any, *sizes: int) -> int:
        """Read as a socket does; TLS reads so, and plain HTTP in its place is told where to go and ended."""
        count = super().recv_into(buffer, *sizes)
        if count and not self._has_begun:
            self._has_begun = True
            first = bytes(memoryview(buffer)[:count])
            if is_plain_http(first):
                with contextlib.suppress(OSError):  # it does not listen
                    self.send(redirection(first))
                return 0
        return count

    def close(self) -> None:
        if self._on_close is not None:
            self._on_close()
            self._on_close = None
        super().close()


class ConnectionMiddleware:
    """ASGI middleware, the outermost: it tells the table which connections ask, and gives up who does not listen."""

    def __init__(self, app: ASGIApp, table: ConnectionTable) -> None:
        self._app, self._table = app, table

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        address, port = scope.get("client") or ("", 0)

        async def send_in_time(message: Message) -> None:
            async with asyncio.timeout(TAKEN_WITHIN_S):
                await send(message)

        try:
            with self._table.asking((address, port), clock.monotonic_s):
                await self._app(scope, receive, send_in_time if scope["type"] == "http" else send)
        except TimeoutError:
            _log.info("%s takes nothing of its answer; the connection is ended", address)


def raise_file_limit() -> int:
    """Allow this process as many open files as it may have, and return how many connections that is."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _MAX_FILES if hard == resource.RLIM_INFINITY else min(hard, _MAX_FILES)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        soft = wanted
    return max(_KEPT_FILES, (_MAX_FILES if soft == resource.RLIM_INFINITY else soft) - _KEPT_FILES)


def quiet_when_full() -> None:
    """Say on the running loop in one line a minute that no connection could be accepted; asyncio tells a page each."""
    limit = RateLimit(1, 60.0)

    def tell(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if not isinstance(error, OSError) or error.errno not in _NO_MORE_FILES:
            loop.default_exception_handler(context)
        elif limit.allows(clock.monotonic_s()):
            _log.warning("No connection could be accepted for a moment: %s.", error.strerror)

    asyncio.get_running_loop().set_exception_handler(tell)
