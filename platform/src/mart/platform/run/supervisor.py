"""Who keeps the processes running: supervisord (https://supervisord.org), its file, and what it is told meanwhile."""

from __future__ import annotations

import contextlib
import http.client
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any
from xmlrpc.client import Error, Fault, ServerProxy

from supervisor.states import RUNNING_STATES, ProcessStates
from supervisor.xmlrpc import SupervisorTransport

from mart.platform.run.identities import identity_dir
from mart.platform.run.plan import (
    PlatformOptions,
    Process,
)
from mart.protocol import clock
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.atomic_file import write_atomically

# A recorder that is verifying an episode gets time to close its file.
_STOP_TIMEOUT_S = 30
_TOLD_TIMEOUT_S = _STOP_TIMEOUT_S + 10  # it answers when what was to stop has stopped
_LOOK_EVERY_S = 0.05
_ALIVE = (*RUNNING_STATES, ProcessStates.STOPPING)
_BIN = Path(sys.executable).parent
_LOG_TAIL_BYTES = 16 * 1024
_REFUSAL = "mart: "  # how a command begins the sentence with which it ends


# Who is needed until the others have ended; all others end first. A recorder verifies what it has closed.
_STOPPED_LATER = (
    {ServiceKind.SIM},
    {ServiceKind.RECORDER, ServiceKind.CATALOGUE},
    {ServiceKind.REPLICA},
    {ServiceKind.ROUTER},
)


class Supervisor:
    """The processes that supervisord keeps running, and its file of them; others may come and go meanwhile.

    Raises Unavailable where supervisord cannot be told; nothing has changed then.
    """

    def __init__(self, options: PlatformOptions, plan: tuple[Process, ...], socket: Path) -> None:
        self._options, self._socket = options, socket
        self._programs = {process.name: (order, process) for order, process in enumerate(plan)}
        self._last = len(plan)
        self._said_before = {name: _size(_log_path(options, name)) for name in self._programs}
        options.logs_dir.mkdir(parents=True, exist_ok=True)
        self.config = options.run_dir / "supervisord.conf"
        self._write()

    @property
    def processes(self) -> tuple[Process, ...]:
        return tuple(process for _, process in self._programs.values())

    def add(self, process: Process) -> None:
        """Starts it, and again whenever it dies."""
        self._change({**self._programs, process.name: (self._last, process)})

    def remove(self, name: str) -> None:
        """Stops it for good. The others keep their order: what supervisord finds changed it would start anew."""
        self._change({other: program for other, program in self._programs.items() if other != name})

    def stop(self) -> None:
        """Stop all and wait for it: together, who does not need each other. Supervisord itself takes one by one."""
        later = set().union(*_STOPPED_LATER)
        with self._remote() as remote:
            for kinds in (set(ServiceKind) - later, *_STOPPED_LATER):
                _stop_together(remote, {one.name for one in self.processes if one.kind in kinds})

    def refusals(self) -> dict[str, str]:
        """Return the sentence with which each process ended that has ended since it was first started, by its name."""
        told: list[dict[str, Any]] = []
        with self._remote() as remote:
            told = remote.getAllProcessInfo()
        names = [info["name"] for info in told if info["stop"] and info["name"] in self._programs]
        return {name: sentence for name in names if (sentence := self._last_refusal(name))}

    @contextlib.contextmanager
    def _remote(self) -> Iterator[Any]:
        """Talk to supervisord (http://supervisord.org/api.html); where it does not answer, the block ends there."""
        transport: Any = SupervisorTransport(None, None, f"unix://{self._socket}")
        with contextlib.closing(transport), contextlib.suppress(OSError, Error, http.client.HTTPException):
            proxy: Any = ServerProxy("http://127.0.0.1", transport=transport)
            yield proxy.supervisor

    def _last_refusal(self, name: str) -> str:
        with contextlib.suppress(OSError):
            log = _log_path(self._options, name)
            before = self._said_before.get(
                name, 0
            )  # by an earlier platform; a log that became shorter begins anew
            said = log.read_bytes()[before if before <= _size(log) else 0 :]
            for line in reversed(said[-_LOG_TAIL_BYTES:].decode(errors="replace").splitlines()):
                if line.startswith(_REFUSAL):
                    return line.removeprefix(_REFUSAL)
        return ""

    def _change(self, programs: dict[str, tuple[int, Process]]) -> None:
        before, self._programs = self._programs, programs
        try:
            self._update()
        except (OSError, MartError) as error:
            self._programs = before
            with contextlib.suppress(OSError):  # a disk that is full; the next change writes it whole
                self._write()
            if isinstance(error, MartError):
                raise
            raise Unavailable(
                f"The supervisor could not be told: {error.strerror}; see `mart doctor`."
            ) from error

    def _update(self) -> None:
        self._write()
        command = [str(_BIN / "supervisorctl"), "--configuration", str(self.config), "update"]
        try:
            done = subprocess.run(  # noqa: S603
                command, check=False, capture_output=True, text=True, timeout=_TOLD_TIMEOUT_S
            )
        except subprocess.TimeoutExpired as error:
            raise Unavailable(f"The supervisor did not answer for {_TOLD_TIMEOUT_S} s.") from error
        if done.returncode:
            raise Unavailable(
                f"The supervisor could not be told: {done.stdout.strip() or done.stderr.strip()}."
            )

    def _write(self) -> None:
        text = configuration(self._options, self._programs.values(), self._socket)
        write_atomically(self.config, text.encode())


def _stop_together(remote: Any, names: set[str]) -> None:
    """Returns when none of these processes runs; supervisord kills one that takes longer than its time."""
    for name in names:
        with contextlib.suppress(Fault):  # it is not running, or was taken away meanwhile
            remote.stopProcess(name, False)
    while any(info["name"] in names and info["state"] in _ALIVE for info in remote.getAllProcessInfo()):
        clock.sleep_s(_LOOK_EVERY_S)


def configuration(options: PlatformOptions, programs: Iterable[tuple[int, Process]], socket: Path) -> str:
    """The text of supervisord.conf: each process with its place in the order of starting; supervisorctl's socket."""
    run_dir = options.run_dir.resolve()
    head = f"""[supervisord]
logfile={_escaped(run_dir / "supervisord.log")}
pidfile={_escaped(run_dir / "supervisord.pid")}

[unix_http_server]
file={socket}
chmod=0600

[rpcinterface:supervisor]
supervisor.rpcinterface_factory=supervisor.rpcinterface:make_main_rpcinterface

[supervisorctl]
serverurl=unix://{socket}
"""
    return head + "\n".join(_program(options, process, order) for order, process in programs)


def _program(options: PlatformOptions, process: Process, order: int) -> str:
    command = " ".join(
        f'"{_escaped(word)}"' for word in (process.program or str(_BIN / "mart"), *process.command)
    )
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
stdout_logfile={_escaped(_log_path(options, process.name))}
stdout_logfile_maxbytes=10MB
stdout_logfile_backups=2
{_environment(options, process)}"""


def _environment(options: PlatformOptions, process: Process) -> str:
    folder = identity_dir(options, process.kind)
    return "" if folder is None else f'environment=MART_BUS_IDENTITY_DIR="{_escaped(folder)}"\n'


def _escaped(value: Path | str) -> str:
    return str(value).replace("%", "%%").replace('"', r"\"")


def _log_path(options: PlatformOptions, name: str) -> Path:
    return options.logs_dir.resolve() / f"{name}.log"


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0
