"""Runs a plan under supervisord (https://supervisord.org): it restarts what dies and stops all in order.

However it ends, nothing is left: supervisord is sent SIGTERM when this process dies, the services end with supervisord,
and whatever still carries the platform's mark is killed, at the latest by the next platform in the same folder.
"""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from uuid import uuid4

from mart.platform.run.folder_claim import ClaimHolder, claimed
from mart.platform.run.identities import identity_dir, issue_identities
from mart.platform.run.plan import (
    PlatformOptions,
    Process,
    environment,
    processes,
)
from mart.platform.run.platform_processes import (
    MARK,
    command_of,
    end_processes,
    environment_of,
    listener_of,
)
from mart.platform.run.supervisor import Supervisor
from mart.protocol import clock, keys
from mart.protocol.errors import Conflict, MartError, Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus.base import Bus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.child_process import start_child
from mart.runtime.privacy import keep_private

_log = logging.getLogger(__name__)

_START_TIMEOUT_S = 90.0
_LOOK_EVERY_S = 1.0
_END_PATIENCE_S = 20.0  # services that end with their supervisor kill themselves 15 s after it


@dataclass(frozen=True)
class Platform:
    """All services are up, whoever runs them. `bus` is a session of our own on their router."""

    options: PlatformOptions
    bus: Bus
    supervisor: Supervisor | None = None  # None: somebody else keeps the services running

    @property
    def url(self) -> str:
        return self.options.url

    def seat_url(self, arm: str) -> str:
        """The address of the operator's page of a seat of the first room."""
        return f"{self.url}rooms/{self.options.room}/arms/{arm}"

    @property
    def join_code(self) -> str:
        return (self.options.data_dir / "join-code").read_text().strip()

    @property
    def host_code_path(self) -> Path:
        return self.options.data_dir / "host-code"

    @property
    def certificate(self) -> Path:
        return self.options.data_dir / "certificates" / "site.crt"

    @property
    def logs_dir(self) -> Path:
        return self.options.logs_dir


@contextlib.contextmanager
def running_platform(options: PlatformOptions, plan: tuple[Process, ...] | None = None) -> Iterator[Platform]:
    """Starts all services, or those of `plan`, and waits for every one's liveliness token; stops them when the block
    ends. For the main thread.

    Raises Conflict where the data folder or a port is taken, and Unavailable where a service does not come up or the
    supervisor dies; the block is interrupted then.
    """
    keep_private(options.data_dir)
    issue_identities(options)
    plan = plan or processes(options)
    mark = uuid4().hex
    url = options.url if any(process.kind == ServiceKind.WEB for process in plan) else ""
    with (
        claimed(options.run_dir, ClaimHolder(os.getpid(), str(options.data_dir.resolve()), mark, url)),
        # Whatever the data folder is called: a socket's path is short.
        tempfile.TemporaryDirectory(prefix="mart-") as private,
    ):
        _require_free(options.host, options.port, "MART's pages", "--port")
        router_host, _, router_port = options.router.rpartition("/")[2].rpartition(":")
        _require_free(router_host, int(router_port), "a Zenoh router", "MART_ROUTER")
        _forget_targets(options)
        supervisor = Supervisor(options, plan, Path(private) / "supervisor")
        with (
            _supervised(options, supervisor, mark) as supervisord,
            _connected(options, supervisord) as bus,
        ):
            _await_alive(bus, options, plan, supervisor)
            yield Platform(options, bus, supervisor)


def _forget_targets(options: PlatformOptions) -> None:
    """Remove what a platform that was killed told Prometheus: another one's processes are elsewhere."""
    for left in options.metrics_dir.glob("*.json"):
        left.unlink(missing_ok=True)


@contextlib.contextmanager
def _supervised(
    options: PlatformOptions, supervisor: Supervisor, mark: str
) -> Iterator[subprocess.Popen[bytes]]:
    module = "mart.platform.run.supervisord"
    words: list[str | Path] = ["--nodaemon", "--silent", "--configuration", supervisor.config]
    with (options.run_dir / "supervisord.out").open("wb") as log:
        supervisord = start_child(
            [sys.executable, "-m", module, *words],
            log,
            {**environment(options), MARK: mark},
            death_signal=signal.SIGTERM,
        )
    died, stopping = threading.Event(), threading.Event()

    def interrupt_when_dead() -> None:
        supervisord.wait()
        if not stopping.is_set():
            died.set()
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    threading.Thread(target=interrupt_when_dead, name="supervisord", daemon=True).start()
    try:
        yield supervisord
    except (KeyboardInterrupt, MartError) as error:
        if died.is_set():
            raise _supervisor_died(supervisord, options) from error
        raise
    else:
        if died.is_set():
            raise _supervisor_died(supervisord, options)
    finally:
        stopping.set()
        try:
            supervisor.stop()
        finally:
            supervisord.terminate()
            supervisord.wait()
            end_processes(mark, _END_PATIENCE_S)


def _supervisor_died(supervisord: subprocess.Popen[bytes], options: PlatformOptions) -> Unavailable:
    status = supervisord.returncode
    how = f"was killed by {signal.Signals(-status).name}" if status < 0 else f"ended with status {status}"
    return Unavailable(
        f"The supervisor of the services (process {supervisord.pid}) {how}, so they were all stopped. "
        f"Start again; {options.run_dir / 'supervisord.log'} may tell why."
    )


def _require_free(host: str, port: int, what: str, setting: str) -> None:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise Conflict(
                f"{what} cannot listen at {host}:{port} ({error.strerror}){_who_listens(port)} "
                f"Stop it, or choose another address with {setting}."
            ) from error


def _who_listens(port: int) -> str:
    """Of a platform in another data folder, also how to stop it."""
    pid = listener_of(port)
    if pid is None:
        return ": is MART running already?"
    who = f": process {pid} ({command_of(pid)}) is there."
    folder = environment_of(pid).get("MART_DATA_DIR")
    return f"{who} `MART_DATA_DIR={folder} mart stop` stops it." if folder else who


@contextlib.contextmanager
def _connected(options: PlatformOptions, supervisord: subprocess.Popen[bytes]) -> Iterator[Bus]:
    deadline_s = clock.monotonic_s() + _START_TIMEOUT_S
    bus: Bus | None = None
    while bus is None:
        try:
            bus = ZenohBus.connect(options.router, False, identity_dir(options, ServiceKind.PLATFORM))
        except Unavailable:
            if supervisord.poll() is not None or clock.monotonic_s() > deadline_s:
                raise
    with bus:
        yield bus


def _await_alive(
    bus: Bus, options: PlatformOptions, plan: tuple[Process, ...], supervisor: Supervisor
) -> None:
    """Raises Unavailable as soon as a service has ended with a sentence of its own, or after the time for a start."""
    awaited = {keys.alive(process.kind, process.id) for process in plan if process.awaited}
    deadline_s = clock.monotonic_s() + _START_TIMEOUT_S
    while missing := awaited - await_alive(bus, keys.EVERY_ALIVE, awaited, _LOOK_EVERY_S):
        for name, sentence in supervisor.refusals().items():
            raise Unavailable(f"{name} does not start: {sentence}")
        if clock.monotonic_s() > deadline_s:
            raise Unavailable(
                f"Not up after {_START_TIMEOUT_S:g} s: {', '.join(sorted(missing))}. "
                f"Their logs are in {options.logs_dir}."
            )
    _log.info("All services are up")
