"""`mart experts`: finds the seats to drive and keeps driving them. One thread; the bus's threads only hand over."""

from __future__ import annotations

import logging
import threading
from dataclasses import dataclass

from mart.operators.room_watch import RoomWatch
from mart.protocol import clock, codec, keys
from mart.protocol.errors import MartError
from mart.protocol.messages import OPERATOR_SCRIPT, RoomStatus, Seat, State
from mart.protocol.tasks import get_task
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus, Publisher
from mart.runtime.service import running
from mart.runtime.throttled_log import ThrottledLog
from mart.sim.experts import Skill, get_skill
from mart.sim.operate import REPEAT_S, ScriptedOperator
from mart.sim.settings import ExpertsSettings

_log = logging.getLogger(__name__)


@dataclass
class _Driven:
    operator: ScriptedOperator
    publisher: Publisher
    repeat_s: float = 0.0


class Experts:
    """Drives every seat that `settings` choose: all `script` seats, or, as intents, one arm whoever sits there."""

    def __init__(self, bus: Bus, settings: ExpertsSettings, skill: Skill) -> None:
        self._bus, self._settings, self._skill = bus, settings, skill
        self._driven: dict[tuple[str, str], _Driven] = {}
        self._watch = RoomWatch(bus, settings.room)

    def run(self, stop: threading.Event) -> None:
        throttled_log, unusable = ThrottledLog(_log), self._watch.unusable
        while not stop.is_set():
            statuses, states = self._watch.take(REPEAT_S / 2)
            for room, status in statuses.items():
                try:
                    self._follow_seats(room, status)
                except MartError as error:
                    unusable[f"{room}: {error}"] += 1
            for room, state in states.items():
                self._show(room, state)
            self._repeat(clock.monotonic_s())
            throttled_log.report(unusable, clock.monotonic_s())
        self._watch.close()

    def _follow_seats(self, room: str, status: RoomStatus) -> None:
        for seat in status.seats:
            place = (room, seat.arm)
            driven = self._driven.get(place)
            if not self._is_mine(seat):
                if driven is not None:
                    self._driven.pop(place).publisher.close()
            elif driven is None or driven.operator.epoch != seat.epoch:
                operator = ScriptedOperator(
                    get_task(status.task, len(status.seats)),
                    seat.arm,
                    seat.epoch,
                    self._skill,
                    self._settings.seed,
                )
                publisher = self._publisher(room, seat.arm) if driven is None else driven.publisher
                self._driven[place] = _Driven(operator, publisher)

    def _is_mine(self, seat: Seat) -> bool:
        if self._settings.arm not in (None, seat.arm):
            return False
        return self._settings.intent or seat.operator == OPERATOR_SCRIPT

    def _publisher(self, room: str, arm: str) -> Publisher:
        topic = keys.intent(room, arm) if self._settings.intent else keys.command(room, arm)
        return self._bus.publisher(topic)

    def _show(self, room: str, state: State) -> None:
        for (place, _), driven in self._driven.items():
            if place == room and driven.operator.see(state):
                driven.repeat_s = 0.0  # say it now

    def _repeat(self, now_s: float) -> None:
        for driven in self._driven.values():
            if now_s >= driven.repeat_s:
                driven.repeat_s = now_s + REPEAT_S
                command = driven.operator.command(clock.wall_ns())
                if command is not None:
                    driven.publisher.put(codec.encode(command))


def serve_experts(settings: ExpertsSettings) -> None:
    """Until the process is asked to stop. Raises NotFound for an unknown skill."""
    skill = get_skill(settings.skill)
    with running(settings, ServiceKind.EXPERTS, settings.id) as service:
        Experts(service.bus, settings, skill).run(service.stop)
