"""Serving the application: socket, certificate and its renewal, start and stop."""

from __future__ import annotations

import asyncio
import contextlib
import datetime as dt
import logging
import socket
import ssl
from collections.abc import Callable

import uvicorn

from mart.protocol import clock
from mart.protocol.errors import Unavailable
from mart.runtime.secret_file import load_or_create_secret
from mart.runtime.service import AsyncService, announced
from mart.web.access.site_names import is_loopback, lan_addresses, site_names
from mart.web.access.user_sessions import UserSessions
from mart.web.api.app_state import AppState
from mart.web.app.application import create_app
from mart.web.app.certificate import Certificate, ensure_certificate
from mart.web.app.security_middleware import MAX_BODY_BYTES
from mart.web.app.settings import WebSettings
from mart.web.lobby.rooms import Rooms

_log = logging.getLogger(__name__)

_STOP_S = 2
_RENEWAL_RETRY_S = 3600.0
_EVERY_ADDRESS = ("0.0.0.0", "::")  # noqa: S104  (only when asked for)


def listen(host: str, port: int) -> socket.socket:
    """Raises Unavailable where the address is taken or not this machine's."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family)
    except OSError as error:
        raise Unavailable(
            f"Could not listen at {host} port {port}: {error.strerror}. Choose another with --host or --port."
        ) from error


async def serve(
    settings: WebSettings, service: AsyncService, listener: socket.socket, join_code: str
) -> None:
    """Until cancelled, or stopped by a signal."""
    names = site_names(settings.public_names, settings.web_host)
    with contextlib.ExitStack() as stack:
        user_sessions = stack.enter_context(contextlib.closing(UserSessions(settings.sessions_path)))
        rooms = stack.enter_context(contextlib.closing(Rooms(service.bus)))
        state = AppState(
            bus=service.bus,
            rooms=rooms,
            user_sessions=user_sessions,
            join_code=join_code,
            secret=load_or_create_secret(settings.secret_path),
            names=names,
            lan_host=_lan_host(settings),
            data_dir=settings.data_dir,
            certificate=settings.certificate or settings.certificates_dir / "site.pem",
        )
        await _serve(settings, service, state, listener)


async def _serve(
    settings: WebSettings, service: AsyncService, state: AppState, listener: socket.socket
) -> None:
    def ensure() -> Certificate:
        return ensure_certificate(settings.certificates_dir, state.names, _now())

    path = settings.certificate or ensure().path
    config = uvicorn.Config(
        create_app(state),
        ssl_certfile=path,
        ssl_keyfile=settings.certificate_key,
        lifespan="off",
        log_config=None,
        log_level="warning",
        access_log=False,
        server_header=False,
        ws="websockets-sansio",
        ws_max_size=MAX_BODY_BYTES,
        timeout_graceful_shutdown=_STOP_S,
    )
    config.load()
    assert config.ssl is not None
    renewal = None if settings.certificate else asyncio.ensure_future(_renew(ensure, config.ssl))
    try:
        await state.rooms.settled()
        # Whoever comes before the server is quite up waits in the listener's queue.
        with announced(service):
            await _run(uvicorn.Server(config), listener)
    finally:
        if renewal is not None:
            renewal.cancel()


async def _run(server: uvicorn.Server, listener: socket.socket) -> None:
    """When cancelled, it first says goodbye to those who are connected."""
    serving = asyncio.ensure_future(server.serve(sockets=[listener]))
    try:
        await asyncio.shield(serving)
    except asyncio.CancelledError:
        server.should_exit = True
        await serving
        raise


async def _renew(ensure: Callable[[], Certificate], context: ssl.SSLContext) -> None:
    """New connections get the new certificate; those that are open keep theirs."""
    while True:
        certificate = ensure()
        context.load_cert_chain(certificate.path)
        wait_s = (certificate.renew_at - _now()).total_seconds()
        await asyncio.sleep(max(wait_s, _RENEWAL_RETRY_S))


def _lan_host(settings: WebSettings) -> str:
    """What a phone should call this site; empty where it cannot reach it."""
    if settings.public_names:
        return next((name for name in settings.public_names if not is_loopback(name)), "")
    if settings.web_host in _EVERY_ADDRESS:
        return next(iter(lan_addresses()), "")
    return "" if is_loopback(settings.web_host) else settings.web_host


def _now() -> dt.datetime:
    return dt.datetime.fromtimestamp(clock.wall_ns() / 1e9, tz=dt.UTC)
