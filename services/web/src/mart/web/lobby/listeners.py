"""Who is told when anything in the lobby changes: one listener for each page that is open."""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Iterator

from mart.web.lobby.room_json import Json

_MAX_WAITING_EVENTS = 64
_MAX_KEPT_EVENTS = 64
_PASSING = ("cue_given",)  # a word of the moment: later it would mislead


class LobbyListener:
    """What one page has not been told yet: whether anything changed, and the newest 64 events."""

    def __init__(self) -> None:
        self._changed = asyncio.Event()
        self._events: deque[Json] = deque(maxlen=_MAX_WAITING_EVENTS)

    def tell(self, event: Json | None = None) -> None:
        """Wake whoever waits, for a change or for `event`."""
        if event is not None:
            self._events.append(event)
        self._changed.set()

    async def wait(self, timeout_s: float) -> None:
        """Return when anything has changed since the last call, or after `timeout_s`."""
        with contextlib.suppress(TimeoutError):
            # not `wait_for`: Python 3.11's swallows a cancellation that comes with the change
            async with asyncio.timeout(timeout_s):
                await self._changed.wait()
        self._changed.clear()

    def take_events(self) -> list[Json]:
        """Return the events since the last call, oldest first."""
        taken = list(self._events)
        self._events.clear()
        return taken


class LobbyListeners:
    """All listeners, and the newest 64 events for those who lose their connection and come back.

    Each event has an `id`, which grows, also across restarts: the time at which it was heard, Unix microseconds.
    """

    def __init__(self) -> None:
        self._listeners: set[LobbyListener] = set()
        self._kept: deque[Json] = deque(maxlen=_MAX_KEPT_EVENTS)
        self._newest_id = 0
        self.changes = 0  # so many times a change was told

    @contextlib.contextmanager
    def listen(self, after: int | None = None) -> Iterator[LobbyListener]:
        """Open a listener for as long as the block runs.

        It begins with the kept events that are newer than the one with the id `after`; with none where it is None.
        """
        listener = LobbyListener()
        if after is not None:
            for event in self._kept:
                if event["id"] > after:
                    listener.tell(event)
        self._listeners.add(listener)
        try:
            yield listener
        finally:
            self._listeners.discard(listener)

    def tell_change(self) -> None:
        """Wake every listener."""
        self.changes += 1
        for listener in self._listeners:
            listener.tell()

    def tell_event(self, event: Json, wall_ns: int) -> None:
        """Give `event`, heard at `wall_ns` (Unix nanoseconds), to every listener."""
        self._newest_id = max(self._newest_id + 1, wall_ns // 1000)
        numbered = {"id": self._newest_id, **event}
        if event["kind"] not in _PASSING:
            self._kept.append(numbered)
        for listener in self._listeners:
            listener.tell(numbered)
