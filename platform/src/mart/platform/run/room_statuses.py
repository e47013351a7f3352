"""Ask the bus how rooms stand: their newest statuses, which each room repeats five times a second."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterable

from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.messages import RoomStatus
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Bus, Sample

_STATUS_TIMEOUT_S = 2.0  # five times a second is promised


def open_rooms(bus: Bus) -> list[RoomStatus]:
    """Return the newest status of every room whose sim is alive, sorted by room; a silent one is left out."""
    alive = {keys.last_of(key) for key in bus.alive(keys.alive_of(ServiceKind.SIM))}
    return statuses_of(bus, alive, _STATUS_TIMEOUT_S)


def statuses_of(bus: Bus, rooms: Iterable[str], timeout_s: float) -> list[RoomStatus]:
    """Return the newest status of every room that speaks, sorted by room, as soon as all of `rooms` have spoken."""
    awaited = set(rooms)
    heard: dict[str, RoomStatus] = {}
    complete = threading.Event()

    def on_status(sample: Sample) -> None:
        status = decode(RoomStatus, sample.payload)
        heard[status.room] = status
        if awaited <= heard.keys():
            complete.set()

    with contextlib.closing(bus.subscribe(keys.EVERY_STATUS, on_status)):
        if awaited:
            complete.wait(timeout_s)
    return [heard[room] for room in sorted(heard)]
