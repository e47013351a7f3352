"""A whole platform with a room, as `mart run` starts it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from mart.platform.run.plan import PlatformOptions
from mart.platform.run.room_manager import opening_rooms
from mart.platform.run.running import Platform, running_platform
from mart.runtime.ports import free_port


@contextlib.contextmanager
def whole_platform(data_dir: Path) -> Iterator[Platform]:
    router = f"tcp/127.0.0.1:{free_port()}"
    options = PlatformOptions(data_dir=data_dir, router=router, port=free_port(), seed=1)
    with running_platform(options) as running, opening_rooms(running):
        yield running
