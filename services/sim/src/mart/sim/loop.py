"""The thread that owns a room, and its way to the bus.

Handlers of the bus run on other threads: they put what came into a mailbox and wake this one. Nothing else is shared.
"""

from __future__ import annotations

import contextlib
import queue
import threading
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import TypeVar

import mujoco

from mart.protocol import clock, codec, keys
from mart.protocol.bus import Bus, Closable, Request, Sample
from mart.protocol.complaints import Complaints
from mart.protocol.errors import InvalidInput, MartError
from mart.protocol.messages import (
    EpisodeRequest,
    Event,
    RoomReply,
    RoomStatus,
    SeatRequest,
    State,
    error_message,
)
from mart.sim import publish
from mart.sim.room import Room
from mart.sim.world import World

R = TypeVar("R", SeatRequest, EpisodeRequest)

MAX_REQUEST_BYTES = 4096
_MAX_EVENT_BYTES = 64 * 1024
_KEPT = 1024
_LONGEST_WAIT_S = 1.0  # so that a stop is noticed


class Mailbox:
    """Work for the room's thread, in the order in which it came. A flood beyond its bound is lost, not kept."""

    def __init__(self) -> None:
        self._queue: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()

    def put(self, work: Callable[[], None]) -> None:
        if self._queue.qsize() < _KEPT:
            self._queue.put(work)

    def work(self, timeout_s: float) -> None:
        """Waits until something is there, at most `timeout_s`, and does all that came until then."""
        with contextlib.suppress(queue.Empty):
            self._queue.get(timeout=max(timeout_s, 0.0))()
            for _ in range(self._queue.qsize()):
                self._queue.get_nowait()()


class BusVoice:
    """Speaks on the keys of a room."""

    def __init__(self, bus: Bus, room: str) -> None:
        self._state = bus.publisher(keys.state(room))
        self._status = bus.publisher(keys.status(room))
        self._event = bus.publisher(keys.event(room))
        self._newest = b""

    def state(self, state: State) -> None:
        state.stamps.sent_ns = clock.wall_ns()
        self._newest = codec.encode(state)
        self._state.put(self._newest)

    def repeat_state(self) -> None:
        self._state.put(self._newest)

    def status(self, status: RoomStatus) -> None:
        self._status.put(codec.encode(status))

    def event(self, event: Event) -> None:
        self._event.put(codec.encode(event))

    def close(self) -> None:
        for publisher in (self._state, self._status, self._event):
            publisher.close()


class Doorway:
    """Everything that comes in from the bus for one room."""

    def __init__(
        self,
        bus: Bus,
        name: str,
        room: Room,
        world: World,
        mailbox: Mailbox,
        *,
        now_s: Callable[[], float] = clock.monotonic_s,
    ) -> None:
        self.garbled: Counter[str] = Counter()  # undecodable payloads by where they came
        self._bus, self._name, self._now_s = bus, name, now_s
        self._room = room
        self._mailbox = mailbox
        self._model = codec.encode(publish.model(world, mujoco.__version__))
        self._open: list[Closable] = [
            bus.subscribe(keys.event(name).key, self._on_event),
            bus.serve(keys.seat(name), self._on_seat_request),
            bus.serve(keys.episode(name), self._on_episode_request),
            bus.serve(keys.model(name), self._on_model_request),
        ]

    def hear_commands(self) -> None:
        """Of operators that are elsewhere."""
        self._open.append(self._bus.subscribe(keys.commands(self._name), self._on_command))

    def close(self) -> None:
        for declared in self._open:
            declared.close()

    def _on_command(self, sample: Sample) -> None:
        hear = partial(
            self._room.hear, sample.payload, keys.arm_of(sample.key), self._now_s(), clock.wall_ns()
        )
        self._mailbox.put(hear)

    def _on_event(self, sample: Sample) -> None:
        try:
            event = codec.decode(Event, sample.payload, _MAX_EVENT_BYTES)
        except InvalidInput:
            self.garbled["event"] += 1
            return
        if event.WhichOneof("what") == "episode_saved":
            self._mailbox.put(partial(self._room.episode_saved, event.episode_saved))

    def _on_seat_request(self, request: Request) -> None:
        self._mailbox.put(partial(self._answer, request, SeatRequest, self._room.answer_seat))

    def _on_episode_request(self, request: Request) -> None:
        self._mailbox.put(partial(self._answer, request, EpisodeRequest, self._room.answer_episode))

    def _on_model_request(self, request: Request) -> None:
        request.reply(self._model)

    def _answer(self, request: Request, kind: type[R], answer: Callable[[R, float], RoomReply]) -> None:
        try:
            reply = answer(codec.decode(kind, request.payload, MAX_REQUEST_BYTES), self._now_s())
        except MartError as error:
            self.garbled["request"] += 1
            reply = RoomReply(error=error_message(error))
        request.reply(codec.encode(reply))


def run(room: Room, doorway: Doorway, mailbox: Mailbox, stop: threading.Event) -> None:
    """Until `stop` is set."""
    complaints = Complaints()
    while not stop.is_set():
        next_s = room.advance(clock.monotonic_s())
        now_s = clock.monotonic_s()
        complaints.say(Counter(room.rejected) + doorway.garbled, now_s)
        mailbox.work(min(next_s - now_s, _LONGEST_WAIT_S))
