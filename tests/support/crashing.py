"""Finds the processes that a supervised platform runs, to kill them as a crash would. Linux only: reads /proc."""

from __future__ import annotations

import contextlib
import os
import re
import signal
from collections.abc import Iterator
from pathlib import Path

from mart.platform.run.running import Platform


def kill_service(platform: Platform, command: str) -> None:
    """kill -9 of `mart {command} …`; the supervisor is left to notice."""
    kill_service_of(platform.options.data_dir, command)


def kill_service_of(data_dir: Path, command: str) -> None:
    """kill -9 of `mart {command} …` of the platform with this data folder."""
    os.kill(_service_pid(data_dir, command), signal.SIGKILL)


@contextlib.contextmanager
def frozen_service(platform: Platform, command: str) -> Iterator[None]:
    """`mart {command} …` does nothing for the length of the block, and its connections stay open."""
    with _frozen(_service_pid(platform.options.data_dir, command)):
        yield


@contextlib.contextmanager
def frozen_seat_process(platform: Platform, arm: str) -> Iterator[None]:
    """The gateway's process for the seat of `arm` does nothing for the length of the block."""
    with _frozen(_seat_pid(platform, arm)):
        yield


def kill_seat_process(platform: Platform, arm: str) -> None:
    """kill -9 of the gateway's process for the seat of `arm`."""
    os.kill(_seat_pid(platform, arm), signal.SIGKILL)


@contextlib.contextmanager
def _frozen(pid: int) -> Iterator[None]:
    os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(pid, signal.SIGCONT)


def _seat_pid(platform: Platform, arm: str) -> int:
    log = next(platform.logs_dir.glob("gateway-*.log")).read_text()
    served = re.findall(rf"{platform.options.room} {arm} is served by process (\d+)", log)
    return int(served[-1])


def _service_pid(data_dir: Path, command: str) -> int:
    supervisor = int(next(data_dir.glob("run/**/supervisord.pid")).read_text())
    (pid,) = (child for child in _children(supervisor) if command in _words(child)[:3])
    return pid


def _children(pid: int) -> list[int]:
    return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def _words(pid: int) -> list[str]:
    return Path(f"/proc/{pid}/cmdline").read_bytes().decode().split("\0")
