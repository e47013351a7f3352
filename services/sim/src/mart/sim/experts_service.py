"""Serve `mart experts`: drive every seat that is set to script, each from what its arm's operator sees."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence

from mart.operators.commander import SeatCommander
from mart.operators.driver import SeatDriver, SeatSelection
from mart.protocol import keys
from mart.protocol.messages import OPERATOR_SCRIPT, RoomStatus, Seat
from mart.protocol.room_task import task_of_room
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.service import running
from mart.sim.experts import ScriptedOperator, Skill, get_skill
from mart.sim.settings import ExpertsSettings


class ScriptSeats(SeatSelection[str]):
    """Select all `script` seats or, to give intents, one arm whoever sits there; each arm drives by itself."""

    kind = ServiceKind.EXPERTS

    def __init__(self, settings: ExpertsSettings, skill: Skill) -> None:
        self._settings, self._skill = settings, skill

    def assigned(self, room: str, status: RoomStatus) -> Mapping[str, Mapping[str, int]]:
        """Return the seats to drive; see `SeatSelection`."""
        return {seat.arm: {seat.arm: seat.epoch} for seat in status.seats if self._is_mine(seat)}

    def commanders(self, key: str, status: RoomStatus) -> Sequence[SeatCommander]:
        """Return one for this arm; see `SeatSelection`."""
        task = task_of_room(status)
        operator = ScriptedOperator(task, key, self._skill, self._settings.seed)
        return [SeatCommander(operator, task, (key,), OPERATOR_SCRIPT)]

    def name_of(self, key: str) -> str:
        """Return what people call it; see `SeatSelection`."""
        return f"The script of {key}"

    def topic(self, room: str, arm: str) -> keys.Topic:
        """Return where its commands, or its intents, go; see `SeatSelection`."""
        return keys.intent(room, arm) if self._settings.intent else super().topic(room, arm)

    def _is_mine(self, seat: Seat) -> bool:
        if self._settings.arm not in (None, seat.arm):
            return False
        return self._settings.intent or seat.operator == OPERATOR_SCRIPT


def serve_experts(settings: ExpertsSettings) -> None:
    """Run until the process is asked to stop. Raises NotFound for an unknown skill."""
    seats = ScriptSeats(settings, get_skill(settings.skill))
    with (
        running(settings, ServiceKind.EXPERTS, settings.id) as service,
        contextlib.closing(SeatDriver(service.bus, settings.room, seats)) as driver,
    ):
        while not service.stop.is_set():
            driver.work()
