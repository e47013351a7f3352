"""Hear what a room says and see what its people are shown, each with its time, from before a fault until long after."""

from __future__ import annotations

import contextlib
import json
import ssl
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect
from websockets.typing import Origin

from mart.platform.collect.web_client import WebClient
from mart.protocol import clock, codec, keys
from mart.protocol.messages import Event, State
from mart.runtime.bus.base import Sample
from tools.chaos.running import ROOM, RunningMart

_SILENT_S = 5.0  # after which a page says that its connection is lost (static/js/live.js, SILENCE_MS)
_AGAIN_S = 0.1


@dataclass(frozen=True)
class Shown:
    """Words that a page shows from a moment on; `at_s` is monotonic."""

    at_s: float
    words: str


class Witness:
    """Every state, every event, and every sentence that a page got, with its monotonic time."""

    def __init__(self, running: RunningMart, client: WebClient) -> None:
        self.states: list[tuple[float, int, int]] = []  # time, tick, episode
        self.events: list[tuple[float, Event]] = []
        self.shown: list[Shown] = []
        self._last = ""
        self._changed = threading.Condition()
        self._closed = threading.Event()
        bus = running.platform.bus
        self._subscriptions = [
            bus.subscribe(keys.state(ROOM).key, self._on_state),
            bus.subscribe(keys.event(ROOM).key, self._on_event),
        ]
        self._page = threading.Thread(target=self._watch, args=(running, client), daemon=True)
        self._page.start()

    def wait_for(self, holds: Callable[[], bool], timeout_s: float) -> bool:
        """Wait until something is so, looking whenever anything is heard; False after the time."""
        deadline_s = clock.monotonic_s() + timeout_s
        with self._changed:
            while not holds():
                left_s = deadline_s - clock.monotonic_s()
                if left_s <= 0:
                    return False
                self._changed.wait(min(left_s, 0.2))
        return True

    def close(self) -> None:
        """Stop listening."""
        self._closed.set()
        for subscription in self._subscriptions:
            subscription.close()
        self._page.join(5.0)

    def _on_state(self, sample: Sample) -> None:
        state = codec.decode(State, sample.payload)
        self._note(lambda: self.states.append((clock.monotonic_s(), state.tick, state.episode)))

    def _on_event(self, sample: Sample) -> None:
        event = codec.decode(Event, sample.payload)
        self._note(lambda: self.events.append((clock.monotonic_s(), event)))

    def _note(self, add: Callable[[], None]) -> None:
        with self._changed:
            add()
            self._changed.notify_all()

    def _show(self, words: str) -> None:
        self._note(lambda: self.shown.append(Shown(clock.monotonic_s(), words)))

    def _watch(self, running: RunningMart, client: WebClient) -> None:
        """Follow what a page gets, as a page does: anew where the connection is lost."""
        url = running.platform.url.rstrip("/")
        context = ssl.create_default_context(cafile=str(running.platform.certificate))
        cookie = "; ".join(f"{one['name']}={one['value']}" for one in client.cookies())
        address = f"{url.replace('https', 'wss', 1)}/api/live"
        while not self._closed.is_set():
            with (
                contextlib.suppress(OSError, WebSocketException, TimeoutError),
                connect(
                    address,
                    ssl=context,
                    additional_headers={"Cookie": cookie},
                    origin=Origin(url),
                    close_timeout=0.2,
                ) as socket,
            ):
                while not self._closed.is_set():
                    self._hear(json.loads(socket.recv(_SILENT_S)))
            if not self._closed.is_set():
                self._show("The connection to the server is lost; it comes back by itself.")
                clock.sleep_s(_AGAIN_S)

    def _hear(self, message: dict[str, Any]) -> None:
        event = message.get("event")
        if event and event["kind"] == "notice":
            self._show(event["text"])
        for room in message.get("rooms", ()):
            words = _in_words(room) if room["room"] == ROOM else self._last
            if words and words != self._last:
                self._show(words)
            self._last = words


def _in_words(room: dict[str, Any]) -> str:
    """What a page shows of a room, as far as it is about faults; empty where all is well."""
    if room.get("stale"):
        return f"{ROOM} does not answer"
    words = [_waiting(one) for one in room.get("waiting_for", ())]
    if room.get("barrier") == "paused":
        words.append("paused")
    if room.get("unrecorded"):
        words.append(f"not recorded: {room['unrecorded']}")
    return "; ".join(words)


def _waiting(late: dict[str, Any]) -> str:
    return f"waiting for {late['name'] or late['arm']} ({late['arm']})"


@contextlib.contextmanager
def witnessing(running: RunningMart, client: WebClient) -> Iterator[Witness]:
    """Listen while the block runs."""
    with contextlib.closing(Witness(running, client)) as witness:
        yield witness
