"""Real processes for system tests: a router on a free port, and `mart …` commands that are up when the block begins.

    with running_router() as endpoint:
        with running_service(["sim", "--room", "room-1"], endpoint, tmp_path, kind="sim", id="room-1") as sim:
            ...
            sim.kill()

Readiness is the liveliness token, never a guess. Whatever was started is dead when its block ends, together with
everything that it started itself.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.protocol import clock, keys
from mart.protocol.errors import Forbidden, Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port

may_start = True  # set for each test by tests/conftest.py

_START_TIMEOUT_S = 60.0
_STOP_TIMEOUT_S = 30.0
_MART = Path(sys.executable).with_name("mart")


class DidNotStart(AssertionError):
    """A process ended, or kept silent for too long, before its liveliness token appeared."""

    def __init__(self, command: Sequence[str], fate: str, log: str) -> None:
        super().__init__(f"`mart {' '.join(command)}` {fate}. It said:\n{log}")


@dataclass(frozen=True)
class Running:
    """One process. Its output, both streams, is in `log_path`."""

    process: subprocess.Popen[bytes]
    log_path: Path

    def log(self) -> str:
        return self.log_path.read_text(errors="replace")

    def terminate(self, timeout_s: float = _STOP_TIMEOUT_S) -> int:
        """Asks it to stop, as a supervisor does, and returns its exit status; raises TimeoutExpired where it stays."""
        self.process.terminate()
        return self.process.wait(timeout_s)

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """It does nothing for the length of the block, and its connections stay open."""
        self.process.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self.process.send_signal(signal.SIGCONT)

    def kill(self) -> None:
        """kill -9 of the process alone; what it started is left as a crash would leave it."""
        self.process.kill()
        self.process.wait()

    def end_group(self) -> None:
        """Ends the process and everything it started."""
        if self.process.poll() is None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.terminate()
        with contextlib.suppress(ProcessLookupError):  # the usual case: nobody is left
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()


@contextlib.contextmanager
def running_router(port: int | None = None) -> Iterator[str]:
    """A router of its own; yields its endpoint."""
    endpoint = f"tcp/127.0.0.1:{port or free_port()}"
    command = ["router", "--listen", endpoint]
    secret = {"MART_BUS_SECRET_FILE": f"{os.environ['XDG_STATE_HOME']}/bus"}  # the same one after a restart
    with running_service(command, endpoint, None, kind="router", id="router", environment=secret):
        yield endpoint


@contextlib.contextmanager
def running_service(
    command: Sequence[str],
    endpoint: str,
    data_dir: Path | None,
    kind: str,
    id: str,
    *,
    environment: Mapping[str, str] | None = None,
    timeout_s: float = _START_TIMEOUT_S,
) -> Iterator[Running]:
    """Starts `mart {command}`; its token `mart/@live/{kind}/{id}` exists when the block begins.

    Raises DidNotStart, with the process's output, where it ends or stays silent for `timeout_s`.
    """
    with started(command, endpoint, data_dir, environment) as running:
        _await_token(running, command, endpoint, keys.alive(ServiceKind(kind), id), timeout_s)
        yield running


@contextlib.contextmanager
def started(
    command: Sequence[str], endpoint: str, data_dir: Path | None, environment: Mapping[str, str] | None = None
) -> Iterator[Running]:
    """Starts `mart {command}` without waiting for anything: for commands that end by themselves."""
    assert may_start, "A unit test starts no processes: mark it with `pytest.mark.system`."
    with tempfile.TemporaryDirectory() as folder:
        log_path = Path(folder) / f"{command[0]}.log"
        with log_path.open("wb") as log:
            process = subprocess.Popen(
                [str(_MART), *command],
                env=_environment(endpoint, data_dir, environment or {}),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,  # a group of its own, to end it with all that it starts
            )
        running = Running(process, log_path)
        try:
            yield running
        finally:
            running.end_group()


def environment_at(endpoint: str) -> dict[str, str]:
    """What a program of somebody's own is started with: nothing but the router's address and its user's folder."""
    return {"MART_ROUTER": endpoint, "XDG_STATE_HOME": os.environ["XDG_STATE_HOME"]}


def _environment(endpoint: str, data_dir: Path | None, more: Mapping[str, str]) -> dict[str, str]:
    inherited = {name: value for name, value in os.environ.items() if not name.startswith("MART_")}
    folder = {} if data_dir is None else {"MART_DATA_DIR": str(data_dir)}
    return {**inherited, "MART_ROUTER": endpoint, **folder, **more}


def _await_token(running: Running, command: Sequence[str], endpoint: str, key: str, timeout_s: float) -> None:
    changed = threading.Event()
    alive = threading.Event()

    def on_token(_key: str, present: bool) -> None:
        if present:
            alive.set()
            changed.set()

    def on_exit() -> None:
        running.process.wait()
        changed.set()

    threading.Thread(target=on_exit, daemon=True).start()
    deadline_s = clock.monotonic_s() + timeout_s
    with (
        _connect(running, command, endpoint, deadline_s) as bus,
        contextlib.closing(bus.watch(key, on_token)),
    ):
        changed.wait(deadline_s - clock.monotonic_s())
    if not alive.is_set():
        raise DidNotStart(command, _fate(running, timeout_s), running.log())


def _connect(running: Running, command: Sequence[str], endpoint: str, deadline_s: float) -> ZenohBus:
    while True:
        try:
            return ZenohBus.connect(endpoint, wait_for_router=False)
        except (Unavailable, Forbidden) as error:  # a router that has just started is noted a moment later
            if running.process.poll() is not None or clock.monotonic_s() > deadline_s:
                raise DidNotStart(command, f"has no router at {endpoint}: {error}", running.log()) from error


def _fate(running: Running, timeout_s: float) -> str:
    status = running.process.poll()
    return f"was not up after {timeout_s:g} s" if status is None else f"ended with exit status {status}"
