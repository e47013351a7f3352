"""The Zenoh router, run from the Python package."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator
from pathlib import Path

import click

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.certificates.identity import is_secured
from mart.runtime.log_format import configure_logging
from mart.runtime.metrics import served_metrics
from mart.runtime.privacy import keep_private
from mart.runtime.router_notes import noted
from mart.runtime.secret_file import load_or_create_secret
from mart.runtime.service import stop_requested
from mart.runtime.settings import Settings


@contextlib.contextmanager
def admitting_router(endpoint: str, secret_path: Path) -> Iterator[ZenohBus]:
    """Give a router that listens at `endpoint` and admits whoever knows the secret at `secret_path`, made at first use.

    Raises InvalidInput for a secret that cannot be used, Unavailable where the address is taken.
    """
    secret = load_or_create_secret(secret_path)
    with ZenohBus.route(endpoint, secret) as bus, noted(endpoint, secret):
        yield bus


@click.command()
@click.option("--listen", help="Endpoint to listen at; default: the one that MART_ROUTER names.")
@click.option(
    "--host", "hosts", multiple=True, help="A name or address of this machine for its certificate; with tls/."
)
def router(listen: str | None, hosts: tuple[str, ...]) -> None:
    """Run the Zenoh router that all services meet at.

    At tcp/HOST:PORT it admits whoever knows its secret, in the data folder. At tls/HOST:PORT it knows each part by its
    certificate, which it issues at first, and gives it the rights of its kind.
    """
    from mart.runtime.certificates.store import CertificateStore
    from mart.runtime.secured_router import serve_secured_router

    settings = Settings()
    endpoint = listen or settings.router
    configure_logging(settings.log_level, ServiceKind.ROUTER, "router", settings.log_format)
    keep_private(settings.data_dir)
    if is_secured(endpoint):
        with stop_requested() as stop, served_metrics(settings, ServiceKind.ROUTER, "router"):
            serve_secured_router(endpoint, CertificateStore(settings.bus_certificates_dir), hosts, stop)
        return
    signals = {signal.SIGTERM, signal.SIGINT}
    signal.pthread_sigmask(signal.SIG_BLOCK, signals)  # before Zenoh's threads start, so that they inherit it
    with (
        admitting_router(endpoint, settings.bus_secret_path) as bus,
        served_metrics(settings, ServiceKind.ROUTER, "router"),
    ):
        token = bus.announce(keys.alive(ServiceKind.ROUTER, "router"))
        signal.sigwait(signals)
        token.close()
