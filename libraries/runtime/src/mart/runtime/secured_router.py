"""Run a router that knows its parts by certificates, and follows what is issued and revoked without a restart."""

from __future__ import annotations

import contextlib
import logging
import socket
import threading
from pathlib import Path

from mart.protocol import keys
from mart.protocol.rights import BusPart
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.access_control import access_control
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.certificates.identity import read_identity
from mart.runtime.certificates.store import ROUTER, CertificateStore
from mart.runtime.certificates.which_identity import now
from mart.runtime.lan_addresses import lan_addresses
from mart.runtime.router_notes import noted

_log = logging.getLogger(__name__)

_LOOK_EVERY_S = 1.0


def serve_secured_router(
    endpoint: str, store: CertificateStore, hosts: tuple[str, ...], stop: threading.Event
) -> None:
    """Route at `endpoint` until `stop`, and issue first what this machine's parts lack.

    Zenoh takes neither rights nor certificates while a session is open. When the ledger changes the session is opened
    anew: every part is back within a second, and what is recorded meanwhile is asked for again (decision 0031).

    hosts: names and addresses of this machine besides those that it knows of.
    """
    store.ensure((*router_hosts(), *hosts), now())
    with noted(endpoint, str((store.folder / BusPart.TOOLS).resolve()).encode()):
        while not stop.is_set():
            seen = _stamp(store.ledger)
            admitted = store.admitted(now())
            identity = read_identity(store.folder / ROUTER, now())
            with (
                ZenohBus.route_secured(endpoint, identity, access_control(admitted)) as bus,
                contextlib.closing(bus.announce(keys.alive(ServiceKind.ROUTER, "router"))),
            ):
                _log.info("Admits %d certificates", sum(map(len, admitted.values())))
                while _stamp(store.ledger) == seen and not stop.wait(_LOOK_EVERY_S):
                    pass


def router_hosts() -> tuple[str, ...]:
    """Return the names and addresses at which a router of this machine is reached."""
    return ("localhost", "127.0.0.1", "::1", socket.gethostname(), *lan_addresses())


def _stamp(path: Path) -> tuple[int, int]:
    """Return what changes when a line is appended."""
    try:
        status = path.stat()
    except FileNotFoundError:
        return 0, 0
    return status.st_size, status.st_mtime_ns
