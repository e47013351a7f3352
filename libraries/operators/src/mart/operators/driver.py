"""Find the seats to drive and keep driving them. One thread; the bus's threads only hand over."""

from __future__ import annotations

import contextlib
import logging
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Generic, TypeVar

from mart.operators.commander import SeatCommander
from mart.operators.room_client import RoomClient
from mart.operators.room_watch import RoomWatch
from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput, MartError
from mart.protocol.messages import OPERATOR_HOLD, Event, RoomStatus, State
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Publisher
from mart.runtime.throttled_log import ThrottledLog

REPEAT_S = 0.1  # while no new state comes: the barrier hears that the operator is still there

_log = logging.getLogger(__name__)

K = TypeVar("K", bound=Hashable)


class SeatSelection(ABC, Generic[K]):
    """Say which seats are driven here, and by what. `K` names what drives together: an arm, a checkpoint, a program."""

    kind: ServiceKind  # who speaks when a seat is given up

    @abstractmethod
    def assigned(self, room: str, status: RoomStatus) -> Mapping[K, Mapping[str, int]]:
        """Return what drives in `room` now, each with the epochs of its seats by arm."""

    @abstractmethod
    def commanders(self, key: K, status: RoomStatus) -> Sequence[SeatCommander]:
        """Return what `key` drives with in a room of this status; raises MartError where it cannot drive there."""

    @abstractmethod
    def name_of(self, key: K) -> str:
        """Return what people call it, to begin a sentence with."""

    def topic(self, room: str, arm: str) -> keys.Topic:
        """Return where the commands for this arm go."""
        return keys.command(room, arm)


@dataclass
class _DrivenSeats:
    commanders: Sequence[SeatCommander]
    publishers: Mapping[str, Publisher]
    epochs: Mapping[str, int] = field(default_factory=dict)
    repeat_s: float = 0.0

    def observe(self, state: State) -> None:
        news = [commander.observe(state) for commander in self.commanders]  # all of them: each must see it
        if any(news):
            self.repeat_s = 0.0  # say it now

    def close(self) -> None:
        for publisher in self.publishers.values():
            publisher.close()


class SeatDriver(Generic[K]):
    """Drive every seat that an selection names. What cannot drive is told to the room, and its seats are given up."""

    def __init__(self, bus: Bus, room: str | None, selection: SeatSelection[K]) -> None:
        """Watch `room` alone; None: every room."""
        self._bus, self._selection = bus, selection
        self._driven: dict[tuple[str, K], _DrivenSeats] = {}
        self._failed: dict[tuple[str, K], Mapping[str, int]] = {}  # with the epochs that were given up
        self._watch = RoomWatch(bus, room)
        self._throttled_log = ThrottledLog(_log)
        self.failure: MartError | None = None  # the newest
        self.heard_s = clock.monotonic_s()  # when a room last said how it is

    def close(self) -> None:
        """Let go of the bus; the seats stay whose they are."""
        self._watch.close()
        for driven in self._driven.values():
            driven.close()

    def work(self) -> Mapping[str, RoomStatus]:
        """Do what has come, or what is due when nothing comes for a moment; returns the newest status of each room."""
        statuses, states = self._watch.take(REPEAT_S / 2)
        if statuses:
            self.heard_s = clock.monotonic_s()
        for room, status in statuses.items():
            self._follow_seats(room, status)
        for room, state in states.items():
            self._show(room, state)
        self._speak(clock.monotonic_s())
        self._throttled_log.report(self._watch.unusable, clock.monotonic_s())
        return statuses

    def _follow_seats(self, room: str, status: RoomStatus) -> None:
        wanted = self._selection.assigned(room, status)
        for place in [place for place in self._driven if place[0] == room and place[1] not in wanted]:
            self._driven.pop(place).close()
        for key, epochs in wanted.items():
            self._guarded((room, key), epochs, partial(self._seat, (room, key), epochs, status))

    def _seat(self, place: tuple[str, K], epochs: Mapping[str, int], status: RoomStatus) -> None:
        driven = self._driven.get(place)
        if driven is not None and driven.epochs == epochs:
            return
        if driven is None:
            driven = self._driven[place] = self._drive(place, status)
        beyond = sorted(epochs.keys() - driven.publishers.keys())
        if beyond:
            raise InvalidInput(f"It drives {', '.join(driven.publishers)} and was given {', '.join(beyond)}.")
        driven.epochs = epochs
        for commander in driven.commanders:
            commander.seat(epochs)

    def _drive(self, place: tuple[str, K], status: RoomStatus) -> _DrivenSeats:
        room, key = place
        commanders = self._selection.commanders(key, status)
        arms = [arm for commander in commanders for arm in commander.arms]
        return _DrivenSeats(
            commanders, {arm: self._bus.publisher(self._selection.topic(room, arm)) for arm in arms}
        )

    def _show(self, room: str, state: State) -> None:
        for place, driven in list(self._driven.items()):
            if place[0] == room:
                self._guarded(place, driven.epochs, partial(driven.observe, state))

    def _speak(self, now_s: float) -> None:
        for driven in self._driven.values():
            if now_s >= driven.repeat_s:
                driven.repeat_s = now_s + REPEAT_S
                for commander in driven.commanders:
                    for command in commander.commands(clock.wall_ns()):
                        driven.publishers[command.arm].put(codec.encode(command))

    def _guarded(self, place: tuple[str, K], epochs: Mapping[str, int], deed: Callable[[], None]) -> None:
        """What fails is told to the room, and its seats are left: people must not wait for it."""
        if self._failed.get(place) == epochs:
            return
        try:
            deed()
        except MartError as error:
            self._failed[place] = epochs
            self.failure = error
            if place in self._driven:
                self._driven.pop(place).close()
            self._give_up(place, epochs, error)

    def _give_up(self, place: tuple[str, K], epochs: Mapping[str, int], error: MartError) -> None:
        room, key = place
        text = f"{self._selection.name_of(key)} left its seat: {error}"
        notice = Event.Notice(level="error", text=text)
        setattr(notice, "from", self._selection.kind)  # a keyword in Python
        _log.error("%s: %s", room, text)
        with contextlib.closing(self._bus.publisher(keys.event(room))) as publisher:
            publisher.put(codec.encode(Event(wall_ns=clock.wall_ns(), room=room, notice=notice)))
        client = RoomClient(self._bus, room)
        for arm in epochs:
            # A room that is gone has no seats to leave; one that refuses has given the seat to somebody else.
            with contextlib.suppress(MartError):
                client.assign(arm, OPERATOR_HOLD)
