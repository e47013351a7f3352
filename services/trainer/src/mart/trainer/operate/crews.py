"""Finds the seats that policies are to drive and keeps driving them. One thread; the bus's threads only hand over."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mart.operators.room_watch import RoomWatch
from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput, MartError, Unavailable
from mart.protocol.messages import OPERATOR_HOLD, Event, RoomStatus, Seat, SeatRequest, State
from mart.protocol.tasks import Task, get_task
from mart.runtime.bus import Bus, Publisher
from mart.runtime.throttled_log import ThrottledLog
from mart.trainer.operate.operator import PolicyOperator, parts_of

if TYPE_CHECKING:
    from mart.trainer.models.policies.policy import Policy

REPEAT_S = 0.1  # while no new state comes: the barrier hears that the policy is still there
_log = logging.getLogger(__name__)

_QUERY_TIMEOUT_S = 3.0

CheckpointOf = Callable[[Seat], Path | None]  # of a seat that is to be driven; None: not by us
Load = Callable[[Path], "Policy"]


@dataclass
class Crew:
    """One policy in one room."""

    epochs: dict[str, int]
    operators: tuple[PolicyOperator, ...]
    publishers: Mapping[str, Publisher]
    repeat_s: float = 0.0

    def close(self) -> None:
        for publisher in self.publishers.values():
            publisher.close()


class Crews:
    """Drives every seat for which `checkpoint_of` names a checkpoint. A seat that cannot be driven is given up."""

    def __init__(self, bus: Bus, room: str | None, checkpoint_of: CheckpointOf, load: Load) -> None:
        self._bus, self._checkpoint_of, self._load = bus, checkpoint_of, load
        self._crews: dict[tuple[str, Path], Crew] = {}
        self._failed: dict[tuple[str, Path], Mapping[str, int]] = {}  # with the epochs that were left
        self._watch = RoomWatch(bus, room)
        self._throttled_log = ThrottledLog(_log)

    def close(self) -> None:
        self._watch.close()
        for crew in self._crews.values():
            crew.close()

    def work(self) -> None:
        """Does what has come, or what is due when nothing comes for a moment."""
        statuses, states = self._watch.take(REPEAT_S / 2)
        for room, status in statuses.items():
            self._follow_seats(room, status)
        for room, state in states.items():
            self._show(room, state)
        self._speak(clock.monotonic_s())
        self._throttled_log.report(self._watch.unusable, clock.monotonic_s())

    def _follow_seats(self, room: str, status: RoomStatus) -> None:
        wanted: dict[tuple[str, Path], dict[str, int]] = {}
        for seat in status.seats:
            checkpoint = self._checkpoint_of(seat)
            if checkpoint is not None:
                wanted.setdefault((room, checkpoint), {})[seat.arm] = seat.epoch
        for place in [place for place in self._crews if place[0] == room and place not in wanted]:
            self._crews.pop(place).close()
        for place, epochs in wanted.items():
            self._guarded(place, epochs, partial(self._seat, place, epochs, status))

    def _seat(self, place: tuple[str, Path], epochs: dict[str, int], status: RoomStatus) -> None:
        crew = self._crews.get(place)
        if crew is not None and crew.epochs == epochs:
            return
        if crew is None:
            crew = self._crews[place] = self._crew(place, status)
        beyond = sorted(epochs.keys() - crew.publishers.keys())
        if beyond:
            raise InvalidInput(f"It drives {', '.join(crew.publishers)} and was given {', '.join(beyond)}.")
        crew.epochs = epochs
        for operator in crew.operators:
            operator.seat(epochs)

    def _crew(self, place: tuple[str, Path], status: RoomStatus) -> Crew:
        room, checkpoint = place
        task = get_task(status.task, len(status.seats))
        policy = self._load(checkpoint)
        require_fit(policy, task, status.control_hz)
        publishers = {arm: self._bus.publisher(keys.command(room, arm)) for arm in policy.arms}
        return Crew({}, tuple(PolicyOperator(part, task) for part in parts_of(policy)), publishers)

    def _show(self, room: str, state: State) -> None:
        for place, crew in list(self._crews.items()):
            if place[0] == room:
                self._guarded(place, crew.epochs, partial(_see, crew, state))

    def _speak(self, now_s: float) -> None:
        for crew in self._crews.values():
            if now_s >= crew.repeat_s:
                crew.repeat_s = now_s + REPEAT_S
                for operator in crew.operators:
                    for command in operator.commands(clock.wall_ns()):
                        crew.publishers[command.arm].put(codec.encode(command))

    def _guarded(self, place: tuple[str, Path], epochs: Mapping[str, int], deed: Callable[[], None]) -> None:
        """What fails is told to the room, and its seats are left: people must not wait for it."""
        if self._failed.get(place) == epochs:
            return
        try:
            deed()
        except MartError as error:
            self._failed[place] = epochs
            if place in self._crews:
                self._crews.pop(place).close()
            self._give_up(place, epochs, error)

    def _give_up(self, place: tuple[str, Path], epochs: Mapping[str, int], error: MartError) -> None:
        room, checkpoint = place
        notice = Event.Notice(level="error", text=f"The policy {checkpoint.name} left its seat: {error}")
        setattr(notice, "from", "policies")  # a keyword in Python
        publisher = self._bus.publisher(keys.event(room))
        publisher.put(codec.encode(Event(wall_ns=clock.wall_ns(), room=room, notice=notice)))
        publisher.close()
        for arm in epochs:
            hold = SeatRequest(assign=SeatRequest.Assign(arm=arm, operator=OPERATOR_HOLD))
            with contextlib.suppress(Unavailable):  # a room that is gone has no seats to leave
                self._bus.query(keys.seat(room), codec.encode(hold), _QUERY_TIMEOUT_S)


def _see(crew: Crew, state: State) -> None:
    for operator in crew.operators:
        if operator.see(state):
            crew.repeat_s = 0.0  # say it now


def require_fit(policy: Policy, task: Task, control_hz: float) -> None:
    """Raises InvalidInput where the policy was not made for such a room."""
    if policy.task != task.name:
        raise InvalidInput(f"It was trained for {policy.task} and the room's task is {task.name}.")
    if abs(policy.control_hz - control_hz) > 1e-6:
        raise InvalidInput(
            f"It was trained at {policy.control_hz:g} ticks a second and the room runs at {control_hz:g}."
        )
    unknown = sorted(set(policy.needs) - {observation.name for observation in task.observations})
    if unknown:
        raise InvalidInput(
            f"It needs {', '.join(unknown)}, which nobody sees in a room of {len(task.arms)} arms."
        )
