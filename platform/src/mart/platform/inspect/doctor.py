"""`mart doctor`: looks at every layer, from the graphics library to the rooms, and names the mend of what is amiss."""

from __future__ import annotations

import asyncio
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mart.platform.collect.browser import chromium_path
from mart.platform.run.folder_claim import claim_holder, leftovers_of
from mart.platform.run.room_statuses import open_rooms
from mart.protocol import clock, keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import barrier_word
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ice_check import check_ice_server
from mart.runtime.ice_servers import IceServer, IceSettings

_NEEDED_KINDS = ("sim", "replica", "experts", "gateway", "recorder", "catalogue", "web")
_MISSED_FOR = {"trainer": "train", "policies": "let a policy drive"}  # what people do without
_PROBE_TIMEOUT_S = 60.0
_SOFTWARE = ("llvmpipe", "softpipe", "swrast")
_LEAST_FREE_BYTES = 2 * 1024**3


@dataclass(frozen=True)
class Diagnosis:
    """One layer. `mend` is empty where nothing is amiss."""

    layer: str
    ok: bool
    found: str
    mend: str = ""

    def as_json(self) -> dict[str, Any]:
        return asdict(self)


def examine(settings: IceSettings) -> Iterator[Diagnosis]:
    """Examine the layers from the machine upwards; what stands on a missing layer is not looked at."""
    yield _graphics()
    yield _chromium()
    yield _disk(settings.data_dir)
    yield _platform(settings.data_dir)
    yield from map(_relay, settings.ice_servers_at(clock.wall_ns() / 1e9))
    router = _router(settings.router)
    yield router
    if router.ok:
        with ZenohBus.connect(settings.router, wait_for_router=False) as bus:
            alive = bus.alive(keys.EVERY_ALIVE)
            for kind in _NEEDED_KINDS:
                yield _service(kind, alive)
            for kind, missed in _MISSED_FOR.items():
                yield _optional(kind, alive, missed)
            for status in open_rooms(bus):
                yield Diagnosis(f"room {status.room}", True, f"{status.task}, {barrier_word(status.barrier)}")


def _graphics() -> Diagnosis:
    """Open a context as the gateway does, in a process of its own: a driver that dies takes nobody along."""
    try:
        asked = subprocess.run(
            [sys.executable, "-m", "mart.render.probe"],
            check=False,
            capture_output=True,
            text=True,
            timeout=_PROBE_TIMEOUT_S,
        )
    except subprocess.TimeoutExpired:
        mend = "set MUJOCO_EGL_DEVICE_ID to another device, or update its driver"
        return Diagnosis("graphics", False, f"no context within {_PROBE_TIMEOUT_S:g} s", mend)
    told = next(iter(asked.stdout.strip().splitlines()[-1:]), "")
    if asked.returncode == 0:
        how = "in software, on the processor" if told.startswith(_SOFTWARE) else "on the graphics card"
        return Diagnosis("graphics", True, f"{told}, {how}")
    if "ModuleNotFoundError" in asked.stderr:
        return Diagnosis("graphics", True, "mart-render is not installed here; pictures are drawn elsewhere")
    mend = "apt-get install libegl1 libgles2 libgl1-mesa-dri; MUJOCO_EGL_DEVICE_ID names the device, if it is set"
    return Diagnosis("graphics", False, told or _last_line(asked.stderr), mend)


def _last_line(text: str) -> str:
    return next(iter(text.strip().splitlines()[-1:]), "the driver ended the process that tried it")


def _chromium() -> Diagnosis:
    try:
        return Diagnosis("chromium", True, chromium_path())
    except Unavailable:
        return Diagnosis("chromium", True, "not installed; only `make demo` and the tests need it")


def _disk(data_dir: Path) -> Diagnosis:
    folder = data_dir.resolve()
    existing = next(parent for parent in (folder, *folder.parents) if parent.exists())
    free_bytes = shutil.disk_usage(existing).free
    found = f"{free_bytes / 1024**3:.1f} GiB free at {folder}"
    if free_bytes >= _LEAST_FREE_BYTES:
        return Diagnosis("disk", True, found)
    return Diagnosis("disk", False, found, "free some space, or set MART_DATA_DIR to a larger disk")


def _platform(data_dir: Path) -> Diagnosis:
    holder = claim_holder(data_dir / "run")
    if holder is not None:
        return Diagnosis("platform", True, f"runs here as {holder.in_words()}")
    left = leftovers_of(data_dir / "run")
    if left is not None:
        found = f"{left.in_words()} was killed, and what it started still runs"
        return Diagnosis("platform", False, found, "`mart stop` ends it, and so does the next `mart run`")
    return Diagnosis("platform", True, "none runs with this data folder on this machine")


def _relay(server: IceServer) -> Diagnosis:
    layer = "TURN" if server.is_relay else "STUN"
    try:
        return Diagnosis(layer, True, f"{server.url} {asyncio.run(check_ice_server(server))}")
    except Unavailable as error:
        mend = "mend the server or MART_ICE_SERVERS; connections on one network do without"
        return Diagnosis(layer, False, str(error), mend)


def _router(endpoint: str) -> Diagnosis:
    host, _, port = endpoint.rpartition("/")[2].rpartition(":")
    try:
        with socket.create_connection((host, int(port)), timeout=1.0):
            pass
        ZenohBus.connect(endpoint, wait_for_router=False).close()
    except MartError as error:
        return Diagnosis("router", False, f"does not let this in at {endpoint}", str(error))
    except OSError as error:
        mend = "start MART with `make run`, or set MART_ROUTER to where it runs"
        return Diagnosis("router", False, f"{endpoint}: {error}", mend)
    return Diagnosis("router", True, f"answers at {endpoint}")


def _service(kind: str, alive: list[str]) -> Diagnosis:
    ids = [keys.last_of(key) for key in alive if key.split("/")[2] == kind]
    if ids:
        return Diagnosis(kind, True, ", ".join(ids))
    return Diagnosis(kind, False, "none is running", f"start it with `mart {kind}` and read its log")


def _optional(kind: str, alive: list[str], missed: str) -> Diagnosis:
    found = _service(kind, alive)
    return found if found.ok else Diagnosis(kind, True, f"none is running; only needed to {missed}")
