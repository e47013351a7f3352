"""Find the seats to drive and keep driving them. One thread; the bus's threads only hand over."""

from __future__ import annotations

import contextlib
import logging
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Generic, TypeVar

from mart.operators.commander import SeatCommander
from mart.operators.room_client import RoomClient
from mart.operators.room_watch import RoomWatch
from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput, MartError, ServiceFault, Unavailable
from mart.protocol.messages import OPERATOR_HOLD, OPERATOR_HUMAN, Cue, Event, RoomStatus, State
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Publisher
from mart.runtime.throttled_log import ThrottledLog

REPEAT_S = 0.1  # while no new state comes: the barrier hears that the operator is still there
LEAVE_AGAIN_S = 5.0
FORGOTTEN_AFTER_S = 60.0  # a room that says nothing
GONE_AFTER_S = 10.0  # one whose sim has no token any more: a sim that is started anew has one within seconds
_FROZEN_S = 5.0  # between two looks: rooms spoke meanwhile, and this process stood still

_log = logging.getLogger(__name__)

K = TypeVar("K", bound=Hashable)


class SeatSelection(ABC, Generic[K]):
    """Say which seats are driven here, and by what. `K` names what drives together: an arm, a checkpoint, a program."""

    kind: ServiceKind  # who speaks when a seat is given up

    @abstractmethod
    def assigned(self, room: str, status: RoomStatus) -> Mapping[K, Mapping[str, int]]:
        """Return what drives in `room` now, each with the epochs of its seats by arm."""

    @abstractmethod
    def commanders(self, key: K, status: RoomStatus) -> Sequence[SeatCommander] | None:
        """Return what `key` drives with in a room of this status; raises where it cannot drive there.

        None: it is not there yet, and is asked for again with the next status.
        """

    @abstractmethod
    def name_of(self, key: K) -> str:
        """Return what people call it, to begin a sentence with."""

    def topic(self, room: str, arm: str) -> keys.Topic:
        """Return where the commands for this arm go."""
        return keys.command(room, arm)


@dataclass
class _FailedSeats:
    """Seats that are left, with their epochs; `again_s`: when to ask once more, where the room still shows them."""

    epochs: Mapping[str, int]
    again_s: float


@dataclass
class _DrivenSeats:
    commanders: Sequence[SeatCommander]
    publishers: Mapping[str, Publisher]
    control_hz: float  # of the room, for which the commanders are made
    epochs: Mapping[str, int] = field(default_factory=dict)
    repeat_s: float = 0.0

    def observe(self, state: State) -> None:
        news = [commander.observe(state) for commander in self.commanders]  # all of them: each must see it
        if any(news):
            self.repeat_s = 0.0  # say it now

    def hear(self, cue: Cue, arm: str, tick: int) -> None:
        for commander in self.commanders:
            commander.hear(cue, arm, tick)

    def speak(self) -> None:
        for commander in self.commanders:
            for command in commander.commands(clock.wall_ns()):
                self.publishers[command.arm].put(codec.encode(command))

    def close(self) -> None:
        for publisher in self.publishers.values():
            publisher.close()


class SeatDriver(Generic[K]):
    """Drive every seat that a selection names. What cannot drive is told to the room, and its seats are given up."""

    def __init__(self, bus: Bus, room: str | None, selection: SeatSelection[K]) -> None:
        """Watch `room` alone; None: every room."""
        self._bus, self._selection = bus, selection
        self._driven: dict[tuple[str, K], _DrivenSeats] = {}
        self._failed: dict[tuple[str, K], _FailedSeats] = {}
        self._heard_s: dict[str, float] = {}  # by room
        self._watch = RoomWatch(bus, room)
        self._people: dict[str, Collection[str]] = {}  # the arms that people drive, by room
        self._throttled_log = ThrottledLog(_log)
        self.failure: MartError | None = None  # the newest
        self._looked_s = self.heard_s = clock.monotonic_s()  # when a room last said how it is

    def close(self) -> None:
        """Let go of the bus; the seats stay whose they are."""
        self._watch.close()
        for driven in self._driven.values():
            driven.close()

    def work(self) -> Mapping[str, RoomStatus]:
        """Do what has come, or what is due when nothing comes for a moment; returns the newest status of each room."""
        statuses, states = self._watch.take(REPEAT_S / 2)
        now_s = clock.monotonic_s()
        self._note_heard(statuses, (*statuses, *states), now_s)
        for room, status in statuses.items():
            self._people[room] = {seat.arm for seat in status.seats if seat.operator == OPERATOR_HUMAN}
            self._follow_seats(room, status)
        for room, state in states.items():
            self._show(room, state)
        for (
            room,
            event,
        ) in self._watch.cues():  # after the states: a reset forgets what was said before it alone
            self._tell(room, event)
        self._forget_silent(now_s)
        self._speak(clock.monotonic_s())
        self._throttled_log.report(self._watch.unusable, clock.monotonic_s())
        return statuses

    def _note_heard(self, statuses: Collection[str], rooms: Collection[str], now_s: float) -> None:
        frozen, self._looked_s = now_s - self._looked_s > _FROZEN_S, now_s
        if statuses or frozen:
            self.heard_s = now_s
        self._heard_s.update(dict.fromkeys((*self._heard_s, *rooms) if frozen else rooms, now_s))

    def _forget_silent(self, now_s: float) -> None:
        silent = {room for room, heard_s in self._heard_s.items() if now_s - heard_s > self._patience_s(room)}
        for place in [place for place in self._driven if place[0] in silent]:
            self._driven.pop(place).close()
        for place in [place for place in self._failed if place[0] in silent]:
            del self._failed[place]
        for room in silent:
            del self._heard_s[room]
            self._people.pop(room, None)
            self._watch.forget(room)

    def _patience_s(self, room: str) -> float:
        return GONE_AFTER_S if self._watch.is_gone(room) else FORGOTTEN_AFTER_S

    def _follow_seats(self, room: str, status: RoomStatus) -> None:
        wanted = self._selection.assigned(room, status)
        for place in [place for place in self._driven if place[0] == room and place[1] not in wanted]:
            self._driven.pop(place).close()
        for key, epochs in wanted.items():
            self._guarded((room, key), epochs, partial(self._seat, (room, key), epochs, status))

    def _seat(self, place: tuple[str, K], epochs: Mapping[str, int], status: RoomStatus) -> None:
        driven = self._driven.get(place)
        if driven is not None and driven.control_hz != status.control_hz:
            self._driven.pop(place).close()  # it drives anew, at the room's new rate
            driven = None
        if driven is not None and driven.epochs == epochs:
            return
        if driven is None:
            driven = self._drive(place, status)
            if driven is None:
                return
            self._driven[place] = driven
        beyond = sorted(epochs.keys() - driven.publishers.keys())
        if beyond:
            raise InvalidInput(f"It drives {', '.join(driven.publishers)} and was given {', '.join(beyond)}.")
        driven.epochs = epochs
        for commander in driven.commanders:
            commander.seat(epochs)

    def _drive(self, place: tuple[str, K], status: RoomStatus) -> _DrivenSeats | None:
        room, key = place
        commanders = self._selection.commanders(key, status)
        if commanders is None:
            return None
        arms = [arm for commander in commanders for arm in commander.arms]
        publishers = {arm: self._bus.publisher(self._selection.topic(room, arm)) for arm in arms}
        return _DrivenSeats(commanders, publishers, status.control_hz)

    def _show(self, room: str, state: State) -> None:
        for place, driven in list(self._driven.items()):
            if place[0] == room:
                self._guarded(place, driven.epochs, partial(driven.observe, state))

    def _tell(self, room: str, event: Event) -> None:
        """Tell those who drive in a room what a person there said to the partners."""
        given = event.cue_given
        if given.arm not in self._people.get(room, ()):
            return
        for place, driven in list(self._driven.items()):
            if place[0] == room:
                self._guarded(place, driven.epochs, partial(driven.hear, given.cue, given.arm, event.tick))

    def _speak(self, now_s: float) -> None:
        for place, driven in list(self._driven.items()):
            if now_s >= driven.repeat_s:
                driven.repeat_s = now_s + REPEAT_S
                self._guarded(place, driven.epochs, driven.speak)

    def _guarded(self, place: tuple[str, K], epochs: Mapping[str, int], deed: Callable[[], None]) -> None:
        """What fails is told to the room, and its seats are left: people must not wait for it."""
        failed = self._failed.get(place)
        if failed is not None and failed.epochs == epochs:
            if clock.monotonic_s() >= failed.again_s:
                self._leave(place, epochs)
            return
        try:
            deed()
        except MartError as error:
            self._fail(place, epochs, error)
        except Exception as error:  # noqa: BLE001 - logged whole; the other seats are driven on
            _log.exception("%s failed", self._selection.name_of(place[1]))
            fault = ServiceFault(f"It failed ({type(error).__name__}: {error}).")
            fault.__cause__ = error
            self._fail(place, epochs, fault)

    def _fail(self, place: tuple[str, K], epochs: Mapping[str, int], error: MartError) -> None:
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
        self._leave(place, epochs)

    def _leave(self, place: tuple[str, K], epochs: Mapping[str, int]) -> None:
        client = RoomClient(self._bus, place[0])
        again_s = math.inf
        for arm in epochs:
            try:
                client.assign(arm, OPERATOR_HOLD)
            except Unavailable:  # where the room is not gone, it says itself that the seat is still held
                again_s = clock.monotonic_s() + LEAVE_AGAIN_S
            except MartError as error:
                _log.info("%s has given %s to somebody else: %s", place[0], arm, error)
        self._failed[place] = _FailedSeats(epochs, again_s)
