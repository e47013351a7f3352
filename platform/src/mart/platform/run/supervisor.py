"""Who keeps the processes running: supervisord (https://supervisord.org), its file, and what it is told meanwhile."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from mart.platform.run.plan import (
    PlatformOptions,
    Process,
)
from mart.protocol.errors import Unavailable

# A recorder that is verifying an episode gets time to close its file.
_STOP_TIMEOUT_S = 30
BIN = Path(sys.executable).parent


class Supervisor:
    """The processes that supervisord keeps running, and its file of them; others may come and go meanwhile."""

    def __init__(self, options: PlatformOptions, plan: tuple[Process, ...], socket: Path) -> None:
        self._options, self._socket = options, socket
        self._programs = {process.name: (order, process) for order, process in enumerate(plan)}
        self._last = len(plan)
        run_dir = options.data_dir / "run"
        logs_dir(options).mkdir(parents=True, exist_ok=True)
        run_dir.mkdir(parents=True, exist_ok=True)
        self.config = run_dir / "supervisord.conf"
        self._write()

    @property
    def processes(self) -> tuple[Process, ...]:
        return tuple(process for _, process in self._programs.values())

    def add(self, process: Process) -> None:
        """Starts it, and again whenever it dies."""
        self._programs[process.name] = self._last, process
        self._update()

    def remove(self, name: str) -> None:
        """Stops it for good. The others keep their order: what supervisord finds changed it would start anew."""
        del self._programs[name]
        self._update()

    def _update(self) -> None:
        self._write()
        command = [str(BIN / "supervisorctl"), "--configuration", str(self.config), "update"]
        done = subprocess.run(command, check=False, capture_output=True, text=True)  # noqa: S603
        if done.returncode:
            raise Unavailable(
                f"The supervisor could not be told: {done.stdout.strip() or done.stderr.strip()}."
            )

    def _write(self) -> None:
        self.config.write_text(configuration(self._options, self._programs.values(), self._socket))


def configuration(options: PlatformOptions, programs: Iterable[tuple[int, Process]], socket: Path) -> str:
    """The text of supervisord.conf: each process with its place in the order of starting; supervisorctl's socket."""
    run_dir = (options.data_dir / "run").resolve()
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
    command = " ".join(f'"{_escaped(word)}"' for word in (str(BIN / "mart"), *process.command))
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
stdout_logfile={_escaped(logs_dir(options).resolve() / f"{process.name}.log")}
stdout_logfile_maxbytes=10MB
stdout_logfile_backups=2
"""


def _escaped(value: Path | str) -> str:
    return str(value).replace("%", "%%").replace('"', r"\"")


def logs_dir(options: PlatformOptions) -> Path:
    return options.data_dir / "logs"
