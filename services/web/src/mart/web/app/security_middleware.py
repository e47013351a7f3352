"""Stands before every request: right name, right origin, a bounded body in time, and headers that keep pages safe."""

from __future__ import annotations

import asyncio
import re
from collections import deque
from urllib.parse import unquote_plus

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from mart.protocol.errors import MartError
from mart.protocol.plain_text import require_plain
from mart.web.access.site_names import SiteNames, host_name
from mart.web.errors import TooLarge, TooSlow, WrongHost, WrongOrigin, error_json, http_status

MAX_BODY_BYTES = 64 * 1024
BODY_TIMEOUT_S = 15.0
_NAMED_BY_DIGEST = "/api/scenes/"
_READING = {"GET", "HEAD", "OPTIONS"}
_CONTENT_POLICY = (
    "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' data:; "
    "media-src 'self' blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_PERMISSIONS = "camera=(), microphone=(), geolocation=(), payment=(), usb=()"
_HEADERS = {
    "Content-Security-Policy": _CONTENT_POLICY,
    "Cross-Origin-Opener-Policy": "same-origin",  # with the next one: a finer performance.now() in the pages
    "Cross-Origin-Embedder-Policy": "require-corp",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": _PERMISSIONS,
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


_TALKING_PAGES = re.compile(r"/rooms/[^/]+/arms/[^/]+|/watch|/host|/phone")


class SecurityMiddleware:
    """ASGI middleware that refuses what must not reach the application, and sets the headers of every answer."""

    def __init__(self, app: ASGIApp, site: SiteNames) -> None:
        self._app = app
        self._site = site

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        try:
            self._check(scope)
            if scope["type"] == "http":
                receive = await _with_whole_body(receive)
        except MartError as error:
            await _refuse(error, scope, receive, send)
        else:
            await self._app(scope, receive, _with_headers(scope, send))

    def _check(self, scope: Scope) -> None:
        require_plain("path", scope["path"])
        require_plain("query", unquote_plus(scope["query_string"].decode("latin-1"), errors="replace"))
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if host_name(host) not in self._site.names:
            # A name that is not ours points here where a foreign page had its own name rebound to this address.
            raise WrongHost(host, self._site.names)
        changes = scope["type"] == "websocket" or scope["method"] not in _READING
        if changes and headers.get("origin") != f"https://{host}":
            raise WrongOrigin(headers.get("origin"))
        # A length must be told: the server then holds the sender to it.
        length = headers.get("content-length", "0")
        if "transfer-encoding" in headers or not length.isdecimal() or int(length) > MAX_BODY_BYTES:
            raise TooLarge(MAX_BODY_BYTES)


async def _with_whole_body(receive: Receive) -> Receive:
    """Read the body, which is short, and return what hands it on; raises TooSlow where it does not come."""
    waiting: deque[Message] = deque()
    try:
        async with asyncio.timeout(BODY_TIMEOUT_S):
            while not waiting or waiting[-1].get("more_body", False):
                waiting.append(await receive())
    except TimeoutError as error:
        raise TooSlow(BODY_TIMEOUT_S) from error

    async def receive_read() -> Message:
        return waiting.popleft() if waiting else await receive()

    return receive_read


async def _refuse(error: MartError, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": str(error)[:120]})
        return
    response = JSONResponse(error_json(error), http_status(error))
    await response(scope, receive, _with_headers(scope, send))


def _with_headers(scope: Scope, send: Send) -> Send:
    """Set the headers of every answer; what says how long it may be kept keeps its word."""

    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers.update(_HEADERS)
            if _TALKING_PAGES.fullmatch(scope["path"]):
                headers["Permissions-Policy"] = _PERMISSIONS.replace("microphone=()", "microphone=(self)")
            headers.setdefault("Cache-Control", _caching(scope["path"], message["status"]))
        await send(message)

    return send_with_headers


def _caching(path: str, status: int) -> str:
    if path.startswith(_NAMED_BY_DIGEST) and status == 200:
        return "private, max-age=31536000, immutable"
    return "no-store" if path.startswith("/api/") else "no-cache"
