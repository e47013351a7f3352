"""Serving the application: socket, certificate and its renewal, start and stop."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import socket
from collections.abc import Coroutine, Hashable
from typing import Any

import uvicorn
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from mart.protocol.errors import Unavailable
from mart.runtime.secret_file import load_or_create_secret
from mart.runtime.service import AsyncService, announced
from mart.web.access.certificate import ensure_certificate
from mart.web.access.connection_table import KEPT_S, ConnectionTable
from mart.web.access.join_code import digest_of
from mart.web.access.site_names import SiteNames
from mart.web.access.user_sessions import UserSessions
from mart.web.api.app_state import AppState
from mart.web.app.application import create_app
from mart.web.app.certificate_renewal import keep_renewed, now
from mart.web.app.guarded_listener import (
    ConnectionMiddleware,
    GuardedListener,
    quiet_when_full,
    raise_file_limit,
)
from mart.web.app.mdns_announcement import keep_announced
from mart.web.app.relay_checks import keep_checking
from mart.web.app.security_middleware import MAX_BODY_BYTES
from mart.web.app.settings import WebSettings
from mart.web.app.site_metrics import keep_shown
from mart.web.clients.missed_saves import MissedSaves
from mart.web.clients.untold_passes import UntoldPasses
from mart.web.lobby.bus_feed import LobbyFeed
from mart.web.lobby.lobby import Lobby

MAX_CONNECTIONS = 2048
_STOP_S = 2
_NAME_TIMEOUT_S = 3.0  # a certificate made later takes the name up within a minute


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens at `host` and `port`.

    Raises Unavailable where the address is taken or not this machine's.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listener = socket.create_server((host, port), family=family)
    except OSError as error:
        raise Unavailable(
            f"Could not listen at {host} port {port}: {error.strerror}. Choose another with --host or --port."
        ) from error
    # What it accepts inherits this. Without it the second piece of an answer waits for word that the first arrived, a
    # round trip; asyncio sets it for sockets that say they are TCP's, which one made by family and type alone does not.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listener


async def serve(
    settings: WebSettings, service: AsyncService, listener: socket.socket, join_code: str, host_code: str
) -> None:
    """Serve the pages and the API at `listener` until cancelled, or stopped by a signal."""
    listener_port = listener.getsockname()[1]
    with contextlib.ExitStack() as stack:
        secret = load_or_create_secret(settings.secret_path)
        digests = (digest_of(join_code, secret), digest_of(host_code, secret))
        sessions = UserSessions(settings.sessions_path, *digests)
        user_sessions = stack.enter_context(contextlib.closing(sessions))
        lobby = Lobby(user_sessions.pass_course)
        feed = stack.enter_context(contextlib.closing(LobbyFeed(service.bus, lobby)))
        state = AppState(
            bus=service.bus,
            lobby=lobby,
            user_sessions=user_sessions,
            join_code=join_code,
            host_code=host_code,
            secret=secret,
            site=SiteNames(settings.public_names, settings.web_host),
            data_dir=settings.data_dir,
            certificate=settings.certificate or settings.certificates_dir / "site.pem",
            ice=settings,
        )
        table = ConnectionTable(
            settings.connections_per_address, min(MAX_CONNECTIONS, raise_file_limit()), settings.proxies
        )
        guarded = stack.enter_context(contextlib.closing(GuardedListener(listener, table)))
        quiet_when_full()
        tasks = await _announced(settings, service, listener_port, state.site)
        config, background = _configured(settings, state, table)
        background += [
            feed.keep_asking(),
            feed.keep_looking(),
            guarded.keep_ending(),
            keep_shown(lobby, table),
            _missed(state),
            UntoldPasses(lobby, user_sessions, state.rooms).keep_telling(),
            keep_checking(settings, state.relays),
        ]
        tasks += [service.bus.spawn(work) for work in background]
        try:
            await feed.settled()
            # Whoever comes before the server is quite up waits in the listener's queue.
            with announced(service):
                await _run(uvicorn.Server(config), guarded)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks)


async def _announced(
    settings: WebSettings, service: AsyncService, port: int, site: SiteNames
) -> list[asyncio.Task[Any]]:
    """Return what answers for the site's name on the local network, once the certificate can be made for it."""
    if not settings.announced_name:
        return []
    settled = asyncio.Event()
    task = service.bus.spawn(keep_announced(settings.announced_name, port, site, settled))
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(_NAME_TIMEOUT_S):
            await settled.wait()
    return [task]


def _configured(
    settings: WebSettings, state: AppState, table: ConnectionTable
) -> tuple[uvicorn.Config, list[Coroutine[Any, Any, None]]]:
    """Return how to serve, and what takes up another certificate meanwhile."""

    def ensure() -> Hashable:
        state.site.look()
        if settings.certificate is not None:
            return settings.certificate.stat().st_mtime_ns
        return ensure_certificate(settings.certificates_dir, state.site.names, now())

    ensure()
    app: Any = create_app(state)
    if settings.proxies:
        app = ProxyHeadersMiddleware(app, list(settings.proxies))
    config = uvicorn.Config(
        ConnectionMiddleware(app, table),
        ssl_certfile=state.certificate,
        ssl_keyfile=settings.certificate_key,
        lifespan="off",
        log_config=None,
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,  # its default believes every process of this machine
        ws="websockets-sansio",
        ws_max_size=MAX_BODY_BYTES,
        timeout_graceful_shutdown=_STOP_S,
        timeout_keep_alive=int(KEPT_S),
    )
    config.load()
    assert config.ssl is not None
    load = functools.partial(config.ssl.load_cert_chain, state.certificate, settings.certificate_key)
    return config, [keep_renewed(ensure, load)]


def _missed(state: AppState) -> Coroutine[Any, Any, None]:
    return MissedSaves(state.lobby, state.catalogue).keep_asking()


async def _run(server: uvicorn.Server, listener: socket.socket) -> None:
    """When cancelled, it first says goodbye to those who are connected."""
    serving = asyncio.ensure_future(server.serve(sockets=[listener]))
    try:
        await asyncio.shield(serving)
    except asyncio.CancelledError:
        server.should_exit = True
        await serving
        raise
