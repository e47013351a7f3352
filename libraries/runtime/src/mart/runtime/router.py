"""The Zenoh router, run from the Python package."""

from __future__ import annotations

import signal

import click

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.service import configure_logging
from mart.runtime.settings import Settings


@click.command()
@click.option("--listen", help="Endpoint to listen at; default: the one that MART_ROUTER names.")
def router(listen: str | None) -> None:
    """Run the Zenoh router that all services meet at."""
    settings = Settings()
    configure_logging(settings.log_level, ServiceKind.ROUTER)
    signals = {signal.SIGTERM, signal.SIGINT}
    signal.pthread_sigmask(signal.SIG_BLOCK, signals)  # before Zenoh's threads start, so that they inherit it
    with ZenohBus.route(listen or settings.router) as bus:
        token = bus.announce(keys.alive(ServiceKind.ROUTER, "router"))
        signal.sigwait(signals)
        token.close()
