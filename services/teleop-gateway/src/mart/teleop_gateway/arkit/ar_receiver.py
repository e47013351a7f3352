"""Listen to the app MuJoCo AR, on one phone at a time.

The app knows neither passwords nor encryption: whoever reaches the port could move the arm. So pages of browsers are
refused (they name an origin), and so is a second phone while the first one speaks.
"""

from __future__ import annotations

import logging
import math
from collections import Counter
from http import HTTPStatus

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from mart.protocol import clock
from mart.protocol.errors import InvalidInput, Unavailable
from mart.runtime.rate_limit import RateLimit
from mart.runtime.throttled_log import ThrottledLog
from mart.teleop_gateway.arkit.ar_message import LONGEST_MESSAGE_CHARS, ARSample, parse_sample

_log = logging.getLogger(__name__)

MAX_MESSAGES_PER_S = 240
SPEAKS_WITHIN_S = 2.0
_QUEUE = 4  # what waits longer is older than what comes next
_CLOSE_S = 1.0  # so long a phone that floods is waited for to say good-bye
_POLICY_VIOLATION = 1008


_wire_log = logging.getLogger(f"{__name__}.wire")
_wire_log.setLevel(logging.WARNING)  # who comes and goes is said here, once


class ARReceiver:
    """Keep the newest sample, and when it came (monotonic seconds; minus infinity before the first)."""

    def __init__(self) -> None:
        self.newest: ARSample | None = None
        self.heard_s = -math.inf
        self._phone: ServerConnection | None = None
        self._not_used: Counter[str] = Counter()
        self._complaints = ThrottledLog(_log)

    async def listen(self, host: str, port: int) -> Server:
        """Begin to listen; closing the answer ends it. Raises Unavailable where that is impossible."""
        try:
            return await serve(
                self._hear,
                host,
                port,
                process_request=self._admit,
                max_size=4 * LONGEST_MESSAGE_CHARS,
                max_queue=_QUEUE,
                compression=None,
                close_timeout=_CLOSE_S,
                ping_interval=None,  # the app answers none while nothing is sent to it
                server_header=None,
                logger=_wire_log,
            )
        except OSError as error:
            raise Unavailable(
                f"Nothing can listen at {host}:{port}: {error.strerror}. Give another --port or --host."
            ) from error

    def _admit(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return a refusal, or None for whoever may speak."""
        if "Origin" in request.headers:
            return connection.respond(HTTPStatus.FORBIDDEN, "This is for the app MuJoCo AR, not for pages.\n")
        if self._phone and clock.monotonic_s() - self.heard_s < SPEAKS_WITHIN_S:
            return connection.respond(HTTPStatus.CONFLICT, "Another phone is connected.\n")
        return None

    async def _hear(self, phone: ServerConnection) -> None:
        before, self._phone = self._phone, phone
        self.newest = None
        self.heard_s = clock.monotonic_s()
        address = phone.remote_address[0]
        _log.info("The app on %s is connected", address)
        if before:
            await before.close()
        limit = RateLimit(MAX_MESSAGES_PER_S)
        try:
            async for message in phone:
                if not limit.allows(clock.monotonic_s()):
                    await phone.close(_POLICY_VIOLATION, f"More than {MAX_MESSAGES_PER_S} messages a second.")
                elif phone is self._phone:
                    self._take(message)
        except ConnectionClosed:
            pass  # phones fall asleep without a word
        finally:
            if phone is self._phone:
                self._phone = self.newest = None
            _log.info("The app on %s is gone", address)

    def _take(self, message: str | bytes) -> None:
        now_s = clock.monotonic_s()
        try:
            self.newest = parse_sample(message)
            self.heard_s = now_s
        except InvalidInput as error:
            self._not_used[str(error)[:80]] += 1
            self._complaints.report(self._not_used, now_s)
