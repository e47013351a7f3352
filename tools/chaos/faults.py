"""The faults: what is done to a platform that runs, for how long, and what people should then be told of by name."""

from __future__ import annotations

import contextlib
import os
import resource
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from mart.protocol import clock, codec, keys
from mart.protocol.messages import Command
from tools.chaos.injected_clock import InjectedClock
from tools.chaos.running import ROOM, RunningMart

_FLOOD_A_SECOND = 10_000
_LISTENER = """
import sys, time
from mart.runtime.bus.zenoh_bus import ZenohBus
with ZenohBus.connect(sys.argv[1]) as bus:
    bus.subscribe("mart/**", lambda sample: None)
    print("up", flush=True)
    time.sleep(600)
"""


@dataclass(frozen=True)
class Scene:
    """What a fault works on."""

    running: RunningMart
    data_dir: Path
    clock: InjectedClock
    may_mount: bool


Does = Callable[[Scene], AbstractContextManager[None]]


@dataclass(frozen=True)
class Fault:
    """One row. `names`: words of which what is told should hold one; empty where nobody needs to notice.

    lasts_s: from its beginning to its end. ends_platform: `mart run` is started anew afterwards.
    """

    name: str
    does: Does
    lasts_s: float
    names: tuple[str, ...] = ()
    ends_platform: bool = False


class NotHere(Exception):
    """This machine does not permit the fault."""


def _killed(part: str) -> Does:
    @contextlib.contextmanager
    def kill(scene: Scene) -> Iterator[None]:
        os.kill(scene.running.pid_of(part), signal.SIGKILL)
        yield

    return kill


def _frozen(part: str) -> Does:
    @contextlib.contextmanager
    def freeze(scene: Scene) -> Iterator[None]:
        pid = scene.running.pid_of(part)
        os.kill(pid, signal.SIGSTOP)
        try:
            yield
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGCONT)

    return freeze


@contextlib.contextmanager
def _hung_up(scene: Scene) -> Iterator[None]:
    os.kill(scene.running.process.pid, signal.SIGHUP)
    yield


@contextlib.contextmanager
def _full(scene: Scene) -> Iterator[None]:
    """Every byte of the data folder's file system; where none could be mounted, a limit on the recorder's files."""
    if not scene.may_mount:
        pid = scene.running.pid_of("recorder")
        before = resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))
        try:
            yield
        finally:
            resource.prlimit(pid, resource.RLIMIT_FSIZE, before)
        return
    filler = scene.data_dir / "filler"
    try:
        with contextlib.suppress(OSError), filler.open("wb", buffering=0) as file:
            while file.write(bytes(1 << 20)):
                pass
        yield
    finally:
        filler.unlink()


@contextlib.contextmanager
def _read_only(scene: Scene) -> Iterator[None]:
    if not scene.may_mount:
        raise NotHere("no file system can be mounted here")
    folder = str(scene.data_dir)
    subprocess.run(["mount", "--bind", folder, folder], check=True)
    try:
        subprocess.run(["mount", "-o", "remount,bind,ro", folder], check=True)
        yield
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


def _clock_set(offset_s: float) -> Does:
    @contextlib.contextmanager
    def set_clock(scene: Scene) -> Iterator[None]:
        if not scene.clock.is_there:
            raise NotHere("there is no C compiler to put a clock before the system's")
        scene.clock.set(offset_s)
        try:
            yield
        finally:
            scene.clock.set(0.0)

    return set_clock


@contextlib.contextmanager
def _slow_reader(scene: Scene) -> Iterator[None]:
    """Somebody on the bus who wants everything and takes nothing."""
    router = scene.running.platform.options.router
    command = [sys.executable, "-c", _LISTENER, router]
    environment = {**os.environ, "MART_DATA_DIR": str(scene.data_dir)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as listener:
        assert listener.stdout is not None
        listener.stdout.readline()
        listener.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            listener.kill()


@contextlib.contextmanager
def _flood(scene: Scene) -> Iterator[None]:
    """Commands that nobody may give, as many as go through."""
    publisher = scene.running.platform.bus.publisher(keys.command(ROOM, "arm0"))
    payload = codec.encode(Command(arm="arm0", seat_epoch=1, sequence=1))
    over = threading.Event()

    def pour() -> None:
        while not over.is_set():
            began_s = clock.monotonic_s()
            for _ in range(_FLOOD_A_SECOND // 100):
                publisher.put(payload)
            clock.sleep_s(max(0.01 - (clock.monotonic_s() - began_s), 0.0))

    pouring = threading.Thread(target=pour)
    pouring.start()
    try:
        yield
    finally:
        over.set()
        pouring.join()
        publisher.close()


# What each part's people are told of: the arm that is waited for, the room, or what is not done meanwhile.
_FELT = {
    "router": (ROOM, "waiting", "connection", "record"),
    "sim": (ROOM,),
    "gateway": ("arm0", "arm1"),
    "seat": ("arm0",),
    "recorder": ("record",),
    "web": ("connection to the server",),
}
_UNFELT = ("catalogue", "replica", "experts", "policies", "trainer")
_ENDS = ("mart-run", "supervisord")
_GONE = ("connection to the server", ROOM)


def every_fault() -> list[Fault]:
    """Return all rows, in the order in which they are tried."""
    parts = [*_FELT, *_UNFELT]
    killed = [Fault(f"kill-{part}", _killed(part), 0.0, _FELT.get(part, ())) for part in parts]
    frozen = [
        Fault(f"freeze{lasts_s:g}-{part}", _frozen(part), lasts_s, _FELT.get(part, ()))
        for lasts_s in (5.0, 20.0)
        for part in parts
    ]
    others = [
        Fault("disk-full", _full, 10.0, ("space", "record", "File too large")),
        Fault("read-only", _read_only, 10.0, ("Read-only", "record")),
        Fault("clock-ahead", _clock_set(3600.0), 10.0),
        Fault("clock-back", _clock_set(-3600.0), 10.0),
        Fault("slow-reader", _slow_reader, 20.0),
        Fault("flood", _flood, 5.0),
    ]
    ends = [Fault(f"kill-{part}", _killed(part), 0.0, _GONE, ends_platform=True) for part in _ENDS]
    return [*killed, *frozen, *others, *ends, Fault("hang-up", _hung_up, 0.0, _GONE, ends_platform=True)]
