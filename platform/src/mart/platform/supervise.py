"""Runs a plan under supervisord (https://supervisord.org): it restarts what dies and stops all in order."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mart.platform.plan import Options, Process, environment, processes
from mart.protocol import clock, keys
from mart.protocol.bus.base import Bus
from mart.protocol.bus.zenoh_bus import ZenohBus
from mart.protocol.errors import Conflict, Unavailable

_log = logging.getLogger(__name__)

_START_TIMEOUT_S = 90.0
# A recorder that is verifying an episode gets time to close its file.
_STOP_TIMEOUT_S = 30
_BIN = Path(sys.executable).parent


@dataclass(frozen=True)
class Platform:
    """All services are up, whoever runs them. `bus` is a session of our own on their router."""

    options: Options
    bus: Bus

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
        return _logs_dir(self.options)


@contextlib.contextmanager
def running_platform(options: Options, plan: tuple[Process, ...] | None = None) -> Iterator[Platform]:
    """Starts all services, or those of `plan`, and waits for every one's liveliness token; stops them when the block
    ends.

    Raises Conflict where a port is taken and Unavailable where a service does not come up.
    """
    _require_free(options.host, options.port, "MART's pages", "--port")
    router_host, _, router_port = options.router.rpartition("/")[2].rpartition(":")
    _require_free(router_host, int(router_port), "a Zenoh router", "MART_ROUTER")
    plan = plan or processes(options)
    run_dir = options.data_dir / "run"
    _logs_dir(options).mkdir(parents=True, exist_ok=True)
    run_dir.mkdir(parents=True, exist_ok=True)
    config = run_dir / "supervisord.conf"
    config.write_text(configuration(options, plan))
    supervisor = subprocess.Popen(  # noqa: S603 - our own command, from our own environment
        [str(_BIN / "supervisord"), "--nodaemon", "--silent", "--configuration", str(config)],
        env={**os.environ, **environment(options)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # a Ctrl-C is for us: we stop the others in order
    )
    try:
        with _connected(options.router, supervisor) as bus:
            _await_alive(bus, options, plan)
            yield Platform(options, bus)
    finally:
        supervisor.send_signal(signal.SIGTERM)
        supervisor.wait()


def configuration(options: Options, plan: tuple[Process, ...]) -> str:
    """The text of supervisord.conf."""
    run_dir = (options.data_dir / "run").resolve()
    head = f"""[supervisord]
logfile={_escaped(run_dir / "supervisord.log")}
pidfile={_escaped(run_dir / "supervisord.pid")}
"""
    return head + "\n".join(_program(options, process, order) for order, process in enumerate(plan))


def _program(options: Options, process: Process, order: int) -> str:
    command = " ".join(f'"{_escaped(word)}"' for word in (str(_BIN / "mart"), *process.command))
    return f"""
[program:{process.name}]
command={command}
priority={order}
autorestart=true
startretries=1000000
stopwaitsecs={_STOP_TIMEOUT_S}
stopasgroup=true
killasgroup=true
redirect_stderr=true
stdout_logfile={_escaped(_logs_dir(options).resolve() / f"{process.name}.log")}
stdout_logfile_maxbytes=10MB
stdout_logfile_backups=2
"""


def _escaped(value: Path | str) -> str:
    return str(value).replace("%", "%%").replace('"', r"\"")


def _logs_dir(options: Options) -> Path:
    return options.data_dir / "logs"


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
def _connected(endpoint: str, supervisor: subprocess.Popen[bytes]) -> Iterator[Bus]:
    deadline_s = clock.monotonic_s() + _START_TIMEOUT_S
    bus: Bus | None = None
    while bus is None:
        try:
            bus = ZenohBus.connect(endpoint, wait_for_router=False)
        except Unavailable:
            if supervisor.poll() is not None or clock.monotonic_s() > deadline_s:
                raise
    with bus:
        yield bus


def _await_alive(bus: Bus, options: Options, plan: tuple[Process, ...]) -> None:
    awaited = {keys.alive(process.kind, process.id) for process in plan if process.awaited}
    present: set[str] = set()
    complete = threading.Event()

    def on_token(key: str, alive: bool) -> None:
        (present.add if alive else present.discard)(key)
        if awaited <= present:
            complete.set()

    with contextlib.closing(bus.watch(keys.EVERY_ALIVE, on_token)):
        if not complete.wait(_START_TIMEOUT_S):
            missing = ", ".join(sorted(awaited - present))
            raise Unavailable(
                f"Not up after {_START_TIMEOUT_S:g} s: {missing}. Their logs are in {_logs_dir(options)}."
            )
    _log.info("All services are up")
