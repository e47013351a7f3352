"""How every service starts and stops: settings → log → bus → liveliness → run → orderly stop."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import signal
import threading
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass
from types import FrameType

from mart.protocol import keys
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Bus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.log_format import configure_logging, set_log_context
from mart.runtime.metrics import served_metrics
from mart.runtime.privacy import keep_private
from mart.runtime.settings import Settings
from mart.runtime.stop_signals import stop_signals

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Service:
    """A running service of one kind. `stop` is set when the process is asked to end."""

    kind: ServiceKind
    id: str
    bus: Bus
    stop: threading.Event


@dataclass(frozen=True)
class AsyncService:
    """The same on an event loop; it is asked to end by cancelling its main task."""

    kind: ServiceKind
    id: str
    bus: AsyncBus


@contextlib.contextmanager
def running(settings: Settings, kind: ServiceKind, id: str) -> Iterator[Service]:
    """A service with a thread of its own (sim, recorder). Its liveliness token lives as long as the block."""
    with connected(settings, kind, id) as service, announced(service):
        yield service


@contextlib.contextmanager
def connected(settings: Settings, kind: ServiceKind, id: str) -> Iterator[Service]:
    """A service that has something to set up before it is `announced`: the token says that it answers.

    While it waits for its router it holds nothing yet, and ends at once when it is asked to.
    """
    _begin(settings, kind, id)
    bus = ZenohBus.connect(settings.router)
    with stop_requested() as stop, bus, served_metrics(settings, kind, id):
        yield Service(kind, id, bus, stop)


@contextlib.contextmanager
def stop_requested() -> Iterator[threading.Event]:
    """An event that is set when the process is asked to end; for the main thread."""
    stop = threading.Event()

    def request_stop(_number: int, _frame: FrameType | None) -> None:
        stop.set()

    before = {number: signal.signal(number, request_stop) for number in stop_signals()}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def announced(service: Service | AsyncService) -> Iterator[None]:
    """The service's liveliness token lives as long as the block."""
    with contextlib.closing(service.bus.announce(keys.alive(service.kind, service.id))):
        _log.info("%s %s is up", service.kind, service.id)
        yield
    _log.info("%s %s stops", service.kind, service.id)


def run_async(
    settings: Settings, kind: ServiceKind, id: str, main: Callable[[AsyncService], Awaitable[None]]
) -> None:
    """An asyncio service (gateway, web): `main` is cancelled when the process is asked to end.

    `main` says itself when the service is `announced`. Until there is a router it is ended as any program is.
    """

    async def supervise() -> None:
        loop = asyncio.get_running_loop()
        with contextlib.closing(bus):
            task = asyncio.ensure_future(main(AsyncService(kind, id, AsyncBus(bus, loop))))
            for number in stop_signals():
                loop.add_signal_handler(number, task.cancel)
            with contextlib.suppress(asyncio.CancelledError):
                await task

    _begin(settings, kind, id)
    bus = ZenohBus.connect(settings.router)
    with served_metrics(settings, kind, id):
        asyncio.run(supervise())


def _begin(settings: Settings, kind: ServiceKind, id: str) -> None:
    configure_logging(settings.log_level, kind, id, settings.log_format)
    if kind is ServiceKind.SIM:
        set_log_context(room=id)
    keep_private(settings.data_dir)
