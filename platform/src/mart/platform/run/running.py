"""Runs a plan under supervisord (https://supervisord.org): it restarts what dies and stops all in order."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import socket
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mart.platform.run.plan import (
    PlatformOptions,
    Process,
    environment,
    processes,
)
from mart.platform.run.supervisor import (
    BIN,
    Supervisor,
    logs_dir,
)
from mart.protocol import clock, keys
from mart.protocol.errors import Conflict, Unavailable
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus.base import Bus
from mart.runtime.bus.zenoh_bus import ZenohBus

_log = logging.getLogger(__name__)

_START_TIMEOUT_S = 90.0


@dataclass(frozen=True)
class Platform:
    """All services are up, whoever runs them. `bus` is a session of our own on their router."""

    options: PlatformOptions
    bus: Bus
    supervisor: Supervisor | None = None  # None: somebody else keeps the services running

    @property
    def url(self) -> str:
        name = self.options.public_host.split(",")[0] or self.options.host
        return f"https://{'localhost' if name == '127.0.0.1' else name}:{self.options.port}/"

    @property
    def join_code(self) -> str:
        return (self.options.data_dir / "join-code").read_text().strip()

    @property
    def certificate(self) -> Path:
        return self.options.data_dir / "certificates" / "site.crt"

    @property
    def logs_dir(self) -> Path:
        return logs_dir(self.options)


@contextlib.contextmanager
def running_platform(options: PlatformOptions, plan: tuple[Process, ...] | None = None) -> Iterator[Platform]:
    """Starts all services, or those of `plan`, and waits for every one's liveliness token; stops them when the block
    ends.

    Raises Conflict where a port is taken and Unavailable where a service does not come up.
    """
    _require_free(options.host, options.port, "MART's pages", "--port")
    router_host, _, router_port = options.router.rpartition("/")[2].rpartition(":")
    _require_free(router_host, int(router_port), "a Zenoh router", "MART_ROUTER")
    plan = plan or processes(options)
    with tempfile.TemporaryDirectory(
        prefix="mart-"
    ) as private:  # whatever the data folder is called: a socket's path is short
        supervisor = Supervisor(options, plan, Path(private) / "supervisor")
        with _supervised(options, supervisor) as supervisord, _connected(options.router, supervisord) as bus:
            _await_alive(bus, options, plan)
            yield Platform(options, bus, supervisor)


@contextlib.contextmanager
def _supervised(options: PlatformOptions, supervisor: Supervisor) -> Iterator[subprocess.Popen[bytes]]:
    supervisord = subprocess.Popen(  # noqa: S603 - our own command, from our own environment
        [str(BIN / "supervisord"), "--nodaemon", "--silent", "--configuration", str(supervisor.config)],
        env={**os.environ, **environment(options)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # a Ctrl-C is for us: we stop the others in order
    )
    try:
        yield supervisord
    finally:
        supervisord.send_signal(signal.SIGTERM)
        supervisord.wait()


def _require_free(host: str, port: int, what: str, setting: str) -> None:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise Conflict(
                f"{what} cannot listen at {host}:{port} ({error.strerror}): is MART running already? "
                f"Stop it, or choose another address with {setting}."
            ) from error


@contextlib.contextmanager
def _connected(endpoint: str, supervisord: subprocess.Popen[bytes]) -> Iterator[Bus]:
    deadline_s = clock.monotonic_s() + _START_TIMEOUT_S
    bus: Bus | None = None
    while bus is None:
        try:
            bus = ZenohBus.connect(endpoint, wait_for_router=False)
        except Unavailable:
            if supervisord.poll() is not None or clock.monotonic_s() > deadline_s:
                raise
    with bus:
        yield bus


def _await_alive(bus: Bus, options: PlatformOptions, plan: tuple[Process, ...]) -> None:
    awaited = {keys.alive(process.kind, process.id) for process in plan if process.awaited}
    missing = awaited - await_alive(bus, keys.EVERY_ALIVE, awaited, _START_TIMEOUT_S)
    if missing:
        raise Unavailable(
            f"Not up after {_START_TIMEOUT_S:g} s: {', '.join(sorted(missing))}. Their logs are in {logs_dir(options)}."
        )
    _log.info("All services are up")
