"""Bring everything from the bus into one inbox: handlers only stamp and hand over, the writer's thread does the rest.

Video travels on a Zenoh session of its own, so that it never delays a state. When the writer cannot keep up, frames are
left out first; states, commands and events only once there is really no room, and then it is said.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto

from mart.protocol import clock, keys
from mart.runtime.bus import Bus, Closable, Sample

MAX_VIDEO_BYTES = 64 * 1024 * 1024
MAX_OTHER_BYTES = 256 * 1024 * 1024
_OVERHEAD_BYTES = 512  # of an arrival, besides its payload


class ArrivalKind(Enum):
    """Name what arrived, by the key it came under."""

    STATE = auto()
    STATUS = auto()
    EVENT = auto()
    COMMAND = auto()
    VIDEO = auto()


@dataclass(frozen=True, slots=True)
class BusArrival:
    """Hold one message as it came from the bus, and when."""

    kind: ArrivalKind
    key: str
    payload: bytes
    arrived_ns: int  # Unix time

    @property
    def room(self) -> str:
        """The room that the key names."""
        return keys.room_of(self.key)

    @property
    def size(self) -> int:
        """How many bytes it takes in the inbox."""
        return len(self.payload) + _OVERHEAD_BYTES


@dataclass(frozen=True)
class InboxBatch:
    """Hold what has arrived, in order, and how much had to be left out since the last batch."""

    arrivals: list[BusArrival]
    lost_frames: int = 0
    lost_messages: int = 0


class Inbox:
    """Queue arrivals without ever making a bus handler wait; what does not fit is left out and counted."""

    def __init__(self, video_bytes: int = MAX_VIDEO_BYTES, other_bytes: int = MAX_OTHER_BYTES) -> None:
        self._limits = {True: video_bytes, False: other_bytes}
        self._held = {True: 0, False: 0}  # is it video → bytes
        self._lost = {True: 0, False: 0}
        self._arrivals: deque[BusArrival] = deque()
        self._changed = threading.Condition()

    def offer(self, arrival: BusArrival) -> None:
        """Put one in, or count it as lost where there is no room."""
        video = arrival.kind is ArrivalKind.VIDEO
        with self._changed:
            if self._held[video] + arrival.size > self._limits[video]:
                self._lost[video] += 1
                return
            self._held[video] += arrival.size
            self._arrivals.append(arrival)
            self._changed.notify()

    def take(self, timeout_s: float) -> InboxBatch:
        """Take everything that has arrived; wait for something at most `timeout_s`."""
        with self._changed:
            if not self._arrivals:
                self._changed.wait(timeout_s)
            batch = InboxBatch(list(self._arrivals), self._lost[True], self._lost[False])
            self._arrivals.clear()
            self._held = {True: 0, False: 0}
            self._lost = {True: 0, False: 0}
        return batch


class RoomSubscriptions:
    """Put what every room sends into an inbox, until closed."""

    def __init__(self, bus: Bus, video_bus: Bus, inbox: Inbox) -> None:
        def into(kind: ArrivalKind) -> Callable[[Sample], None]:
            return lambda sample: inbox.offer(BusArrival(kind, sample.key, sample.payload, clock.wall_ns()))

        self._subscriptions: list[Closable] = [
            bus.subscribe(keys.EVERY_STATE, into(ArrivalKind.STATE), recover=True),
            bus.subscribe(keys.EVERY_STATUS, into(ArrivalKind.STATUS)),
            bus.subscribe(keys.EVERY_EVENT, into(ArrivalKind.EVENT), recover=True),
            bus.subscribe(keys.EVERY_COMMAND, into(ArrivalKind.COMMAND), recover=True),
            video_bus.subscribe(keys.EVERY_VIDEO, into(ArrivalKind.VIDEO)),
        ]

    def close(self) -> None:
        """End the subscriptions."""
        while self._subscriptions:
            self._subscriptions.pop().close()
