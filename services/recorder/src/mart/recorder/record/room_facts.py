"""Know of what room a file is: its task, rate, model and people. Pure."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from mart.protocol.messages import Event, Model, Numerics, RoomStatus, Seat
from mart.protocol.recording import RoomRecord

_TASK_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")
_MAX_NAMES = 1024  # seats change hands; the oldest names are forgotten


@dataclass
class RoomFacts:
    """Gather what is known about a room besides its states, from whatever says it."""

    room: str
    task: str | None = None
    control_hz: float | None = None
    model_sha256: str | None = None
    mujoco_version: str | None = None
    arm_kinds: tuple[str, ...] = ()
    numerics: Numerics = field(default_factory=Numerics)
    names: dict[tuple[str, int], str] = field(default_factory=dict)  # (arm, seat epoch) → who

    def of_next_run(self) -> RoomFacts:
        """Return what still holds when the sim has started anew, perhaps at another rate: its task, and who was who."""
        return RoomFacts(self.room, self.task, arm_kinds=self.arm_kinds, names=dict(self.names))

    def learn_status(self, status: RoomStatus) -> None:
        """Learn task, control rate and who sits where."""
        self._learn_task(status.task, status.control_hz)
        self.arm_kinds = tuple(status.arm_kinds)
        self._learn_seats(status.seats)

    def learn_event(self, event: Event) -> None:
        """Learn what an episode's announcement or a change of a seat says."""
        if event.HasField("episode_started"):
            started = event.episode_started
            self._learn_task(started.task, started.control_hz)
            self._learn_seats(started.seats)
            self.model_sha256 = started.model_sha256 or self.model_sha256
        elif event.HasField("seat_changed"):
            self._learn_seats([event.seat_changed])

    def learn_model(self, model: Model) -> None:
        """Learn which compiled model the room steps, and with which MuJoCo."""
        self._learn_task(model.task, model.control_hz)
        self.model_sha256, self.mujoco_version = model.sha256, model.mujoco_version
        self.arm_kinds, self.numerics = tuple(model.arm_kinds), model.numerics

    def learn_record(self, record: RoomRecord) -> None:
        """Learn what the room's record in a file says."""
        self._learn_task(record.task or "", record.control_hz or 0.0)
        self.model_sha256 = record.model_sha256 or self.model_sha256
        self.mujoco_version = record.mujoco_version or self.mujoco_version
        self.arm_kinds = record.arm_kinds or self.arm_kinds
        if record.numeric_fingerprint:
            self.numerics = record.numerics

    @property
    def is_complete(self) -> bool:
        """Whether enough is known to step the room's world again."""
        return bool(self.task and self.control_hz and self.model_sha256)

    def record(self) -> RoomRecord:
        """Return the record of the room as it is written into a file."""
        return RoomRecord(
            room=self.room,
            task=self.task,
            control_hz=self.control_hz,
            model_sha256=self.model_sha256,
            mujoco_version=self.mujoco_version,
            arm_kinds=self.arm_kinds,
        ).with_numerics(self.numerics)

    def _learn_task(self, task: str, control_hz: float) -> None:
        if _TASK_NAME.fullmatch(task):  # it becomes part of a file's name
            self.task = task
        if np.isfinite(control_hz) and control_hz > 0:
            self.control_hz = control_hz

    def _learn_seats(self, seats: Iterable[Seat]) -> None:
        for seat in seats:
            self.names[seat.arm, seat.epoch] = seat.name
        while len(self.names) > _MAX_NAMES:
            del self.names[next(iter(self.names))]
