"""Show a process's figures to Prometheus: `/metrics` at a port of its own, off unless MART_METRICS_PORT gives one.

Every part declares its figures on `REGISTRY`, which is one for each process, and sets them where they are known anyway.
A scrape reads them on a thread of its own, one after another, so it holds up no event loop and no tick.

With MART_METRICS_TARGETS_DIR each process says where it listens, in a file that Prometheus follows (`file_sd_configs`).
It takes the file away when it ends; that of a process which was killed stays, so that it is seen to be down.
"""

from __future__ import annotations

import contextlib
import json
import logging
import signal
import socket
import socketserver
import threading
from collections.abc import Iterator
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from importlib.metadata import version
from pathlib import Path

from prometheus_client import (
    CollectorRegistry,
    Gauge,
    GCCollector,
    ProcessCollector,
    disable_created_metrics,
)
from prometheus_client.exposition import choose_encoder

from mart.protocol.vocabulary import ServiceKind
from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.runtime.lan_addresses import lan_addresses
from mart.runtime.settings import Settings

_log = logging.getLogger(__name__)

PATH = "/metrics"
_EVERY_ADDRESS = ("0.0.0.0", "::")  # noqa: S104 - told apart, not listened at
_PATIENCE_S = 5.0  # for a scraper's request; scrapes come one after another

disable_created_metrics()  # type: ignore[no-untyped-call]  # when each counter began: twice as many series, and process_start_time_seconds tells it
REGISTRY = CollectorRegistry()
ProcessCollector(registry=REGISTRY)
GCCollector(registry=REGISTRY)
_INFO = Gauge(
    "mart_service_info", "1, with what this process is.", ("kind", "name", "version"), registry=REGISTRY
)


@contextlib.contextmanager
def served_metrics(settings: Settings, kind: ServiceKind, id: str) -> Iterator[None]:
    """Answer scrapes of this process while the block runs, where the settings give a port.

    A port that is taken is logged and costs the figures, never the service.
    """
    if settings.metrics_port is None:
        yield
        return
    try:
        server = _MetricsServer(settings.metrics_host, settings.metrics_port)
    except OSError as error:
        _log.error(
            "No figures are shown: nothing can listen at %s port %d (%s). Choose another MART_METRICS_PORT, or 0 for "
            "any free one.",
            settings.metrics_host,
            settings.metrics_port,
            error.strerror,
        )
        yield
        return
    _INFO.labels(kind, id, version("mart-runtime")).set(1)
    with server, _listed(settings, server.port, kind, id):
        _start(server)
        try:
            yield
        finally:
            server.shutdown()


def targets(host: str, port: int, kind: ServiceKind, id: str) -> bytes:
    """Return the text of a file of Prometheus's file_sd with this one process.

    `instance` is what the process is and not where it listens: its series go on when it is started anew.
    """
    address = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
    labels = {"instance": f"{kind}/{id}", "service": str(kind), "id": id}
    return json.dumps([{"targets": [address], "labels": labels}]).encode()


@contextlib.contextmanager
def _listed(settings: Settings, port: int, kind: ServiceKind, id: str) -> Iterator[None]:
    """Keep a file of where this process listens while the block runs, where the settings name a folder."""
    if settings.metrics_targets_dir is None:
        yield
        return
    path = settings.metrics_targets_dir / f"{kind}-{id}.json"
    content = targets(_reached_at(settings.metrics_host), port, kind, id)
    try:
        write_atomically(path, content, PUBLIC)
        path.chmod(PUBLIC)  # Prometheus may be another user; what a service makes is its own otherwise
    except OSError as error:
        _log.error("Prometheus does not find this process: %s: %s", path, error.strerror)
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            _remove(path, content)


def _remove(path: Path, content: bytes) -> None:
    """Remove a file unless a later process has written its own meanwhile."""
    if path.read_bytes() == content:
        path.unlink()


def _reached_at(host: str) -> str:
    """Return the address at which others reach what listens at `host`."""
    return next(iter(lan_addresses()), "127.0.0.1") if host in _EVERY_ADDRESS else host


def _start(server: _MetricsServer) -> None:
    # A signal to the process must reach the main thread, which may wait for it.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
    threading.Thread(target=server.serve_forever, name="metrics", daemon=True).start()
    signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _MetricsHandler(BaseHTTPRequestHandler):
    timeout = _PATIENCE_S

    def do_GET(self) -> None:
        if self.path.partition("?")[0] != PATH:
            self.send_error(HTTPStatus.NOT_FOUND, f"Only {PATH} is here")
            return
        encode, content_type = choose_encoder(self.headers.get("Accept", ""))
        body = encode(REGISTRY)
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing: a scrape comes every few seconds."""


class _MetricsServer(socketserver.TCPServer):
    """Listen at a TCP port; raises OSError where that cannot be. One request at a time: who scrapes waits its turn."""

    allow_reuse_address = True

    def __init__(self, host: str, port: int) -> None:
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        super().__init__((host, port), _MetricsHandler)

    @property
    def port(self) -> int:
        """The port that it listens at."""
        port: int = self.socket.getsockname()[1]
        return port

    def handle_error(self, request: object, client_address: object) -> None:
        """Take that a scraper went away in between."""
        _log.debug("A scrape by %s failed", client_address, exc_info=True)
