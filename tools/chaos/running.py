"""Run `mart run` as a person does, find its processes, and seat emulated people in it."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from mart.platform.collect.emulated_users import EmulatedUser, EmulatedUsers
from mart.platform.run.folder_claim import claim_holder
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.platform_processes import processes_of
from mart.platform.run.running import Platform
from mart.protocol import clock
from mart.protocol.errors import Conflict
from mart.runtime.bus.zenoh_bus import ZenohBus

_MART = Path(sys.executable).with_name("mart")
_STOP_TIMEOUT_S = 60.0
_SEAT_TIMEOUT_S, _SEAT_AGAIN_S = 90.0, 2.0
ROOM = "room-1"


@dataclass(frozen=True)
class RunningMart:
    """One `mart run` that is up. `started_in_s`: how long that took."""

    process: subprocess.Popen[str]
    platform: Platform
    mark: str
    started_in_s: float

    def pid_of(self, part: str) -> int:
        """Return the process id of a part: `mart-run`, `supervisord`, `seat`, or a `mart` command."""
        if part == "mart-run":
            return self.process.pid
        if part == "supervisord":
            return int((self.platform.options.run_dir / "supervisord.pid").read_text())
        if part == "seat":
            return self._seat("arm0")
        words = {pid: _words(pid) for pid in processes_of(self.mark)}
        (pid,) = (pid for pid, command in words.items() if part in command[1:3] and _is_mart(command))
        return pid

    def commands(self) -> Counter[str]:
        """Return what runs with the platform's mark, by its command."""
        return Counter(" ".join(_words(pid)[1:4]) for pid in processes_of(self.mark))

    def _seat(self, arm: str) -> int:
        (path,) = self.platform.logs_dir.glob("gateway-*.log")
        log = path.read_text(errors="replace")
        return int(re.findall(rf"{ROOM} {arm} is served by process (\d+)", log)[-1])


def _words(pid: int) -> list[str]:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace").split("\0")
    return []


def _is_mart(words: list[str]) -> bool:
    return any(word.endswith("/mart") for word in words[:2])


@contextlib.contextmanager
def running_mart(
    data_dir: Path, router: str, port: int, environment: Mapping[str, str]
) -> Iterator[RunningMart]:
    """Start `mart run` and wait until it says where it is; asked to stop when the block ends."""
    own = {**os.environ, **environment, "MART_ROUTER": router, "MART_DATA_DIR": str(data_dir)}
    began_s = clock.monotonic_s()
    command = [str(_MART), "run", "--json", "--control-hz", "20", "--port", str(port)]
    with (data_dir.parent / "mart-run.log").open("ab") as log:
        process = subprocess.Popen(
            command, env=own, stdout=subprocess.PIPE, stderr=log, text=True, start_new_session=True
        )
    try:
        assert process.stdout is not None
        told = process.stdout.readline()
        if not told:
            raise RuntimeError(
                f"`mart run` ended with {process.wait()}; see {data_dir.parent / 'mart-run.log'}."
            )
        assert json.loads(told)["url"]
        holder = claim_holder(data_dir / "run")
        assert holder is not None
        options = PlatformOptions(data_dir, router=router, port=port)
        with ZenohBus.connect(router) as bus:
            yield RunningMart(process, Platform(options, bus), holder.mark, clock.monotonic_s() - began_s)
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGCONT)
            process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_STOP_TIMEOUT_S)
        process.kill()
        process.wait()


@contextlib.contextmanager
def seated(running: RunningMart, seed: int) -> Iterator[list[EmulatedUser]]:
    """Two emulated people drive the room; after a restart as soon as the seats of those before are free."""
    users = EmulatedUsers(running.platform, skill="average", seed=seed)
    with contextlib.ExitStack() as stack:
        yield _seat(users, stack)


def _seat(users: EmulatedUsers, stack: contextlib.ExitStack) -> list[EmulatedUser]:
    deadline_s = clock.monotonic_s() + _SEAT_TIMEOUT_S
    while True:
        try:
            return stack.enter_context(users.seated(("arm0", "arm1")))
        except Conflict:
            if clock.monotonic_s() > deadline_s:
                raise
        clock.sleep_s(_SEAT_AGAIN_S)
