"""`mart doctor`: looks at every layer, from the graphics library to the rooms, and names the mend of what is amiss."""

from __future__ import annotations

import ctypes.util
import shutil
import socket
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mart.platform.collect.browser import chromium_path
from mart.platform.run.room_statuses import open_rooms
from mart.protocol import keys
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.messages import barrier_word
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.settings import Settings

_NEEDED_KINDS = ("sim", "replica", "experts", "gateway", "recorder", "catalogue", "web")
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


def examine(settings: Settings) -> Iterator[Diagnosis]:
    """Examine the layers from the machine upwards; what stands on a missing layer is not looked at."""
    yield _graphics()
    yield _chromium()
    yield _disk(settings.data_dir)
    router = _router(settings.router)
    yield router
    if router.ok:
        with ZenohBus.connect(settings.router, wait_for_router=False) as bus:
            alive = bus.alive(keys.EVERY_ALIVE)
            for kind in _NEEDED_KINDS:
                yield _service(kind, alive)
            for status in open_rooms(bus):
                yield Diagnosis(f"room {status.room}", True, f"{status.task}, {barrier_word(status.barrier)}")


def _graphics() -> Diagnosis:
    if ctypes.util.find_library("EGL"):
        return Diagnosis("graphics", True, "EGL is there")
    return Diagnosis("graphics", False, "no EGL library", "apt-get install libegl1 libgles2 libgl1-mesa-dri")


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
