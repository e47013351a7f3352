"""Keep what a room knows over a restart, a crash included: seed, count of episodes, seats with their epochs, a stop."""

from __future__ import annotations

import logging
import secrets
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from mart.protocol import clock
from mart.protocol.errors import Corrupt
from mart.protocol.messages import operator_from_word, operator_word
from mart.protocol.received import MAX_COUNTER, MAX_NUMBER
from mart.protocol.vocabulary import OperatorKind
from mart.runtime.atomic_file import write_atomically
from mart.sim.room.seats import SeatHolder, SeatOperator

_log = logging.getLogger(__name__)

_SEED_BITS = 32
_MAX_COUNTED = 256
_MAX_AWAITED = 4  # after a restart


class SavedDriver(BaseModel):
    """Store who drives, in words."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    operator: OperatorKind
    holder_id: str
    name: str
    policy: str = ""

    def driver(self) -> SeatOperator:
        """Return the driver that this stores."""
        return SeatOperator(operator_from_word(self.operator), self.holder_id, self.name, self.policy)


class SavedSeat(SavedDriver):
    """Store one seat, and the machine that its human relieved."""

    arm: str
    epoch: int = Field(ge=1, le=MAX_COUNTER)
    relieved: SavedDriver | None = None
    passed_course: bool = False

    def holder(self) -> SeatHolder:
        """Return the seat that this stores."""
        relieved = self.relieved.driver() if self.relieved else None
        return SeatHolder(self.arm, self.epoch, self.driver(), relieved, self.passed_course)

    def freed(self) -> SavedSeat:
        """Return the seat after its holder is gone."""
        return SavedSeat(
            arm=self.arm, epoch=self.epoch + 1, operator=OperatorKind.HOLD, holder_id="", name=""
        )


class SavedPlan(BaseModel):
    """Store that so many good `episodes` of `task` are wanted; `good_before`: the good ones when that was said."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    task: str
    episodes: int = Field(ge=1, le=MAX_NUMBER)
    good_before: int = Field(ge=0, le=MAX_NUMBER)


class SavedHostPlan(BaseModel):
    """Store that a host wants `episodes` good ones of `task` (0: no plan) in place of those that were `asked` for."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    task: str
    asked: int | None = Field(ge=1, le=MAX_NUMBER)
    episodes: int = Field(ge=0, le=MAX_NUMBER)


class SavedStop(BaseModel):
    """Store a stop that is on: `name` pressed it, at `arm` where they held a seat; a host's pause where `by_host`.

    fault: what was wrong, where a driver stopped it. under: the stop that a host's pause lies over.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    arm: str
    name: str
    wall_ns: int = Field(ge=0)
    by_host: bool = False
    fault: str = ""
    under: SavedStop | None = None


class CountedEpisode(BaseModel):
    """Store that an episode was counted among the saved ones, and whether among the good ones."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    number: int = Field(ge=1)
    good: bool


class SavedRoom(BaseModel):
    """Store one room: `episodes` is the newest number; `saved` and `good` count what the recorder reported.

    counted: the newest of them, so that what is told again counts once. task: that the seats are for, empty in records
    of 0.2 and older. picture_s: what a seat's picture took here; 0: nobody has said, or nobody asked. asked: how many
    good ones whoever started the room wanted; host_plan: what a host said instead, until the room is asked for others.
    course_required: whether people must have passed the practice course to record; course_asked: whether whoever
    started the room wanted it so.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    seed: int = Field(ge=0)
    task: str = ""
    episodes: int = Field(0, ge=0, le=MAX_NUMBER)
    saved: int = Field(0, ge=0, le=MAX_NUMBER)
    good: int = Field(0, ge=0, le=MAX_NUMBER)
    counted: tuple[CountedEpisode, ...] = ()
    seats: tuple[SavedSeat, ...] = ()
    plan: SavedPlan | None = None
    course_required: bool = False
    course_asked: bool = False
    asked: int | None = Field(None, ge=1, le=MAX_NUMBER)
    host_plan: SavedHostPlan | None = None
    stop: SavedStop | None = None
    picture_s: float = Field(0.0, ge=0.0, le=10.0)

    def for_task(self, task: str) -> SavedRoom:
        """Return it for a world of this task: seats of another task are free, under epochs that nobody has yet."""
        seats = self.seats if self.task in ("", task) else tuple(seat.freed() for seat in self.seats)
        return self.with_changes(task=task, seats=seats)

    def planned(self, task: str, episodes: int | None) -> SavedRoom:
        """Return it as it begins to run where so many good episodes of this task are asked for; None: no plan.

        A restart asks for the same again: what a host said meanwhile holds.
        """
        said = self.host_plan
        if said is not None and (said.task, said.asked) == (task, episodes):
            return _wanting(self, task, said.episodes or None)
        return _wanting(self.with_changes(asked=episodes, host_plan=None), task, episodes)

    def with_host_plan(self, episodes: int) -> SavedRoom:
        """Return it with what a host wants: so many good episodes of its task from now on; 0: no plan."""
        said = SavedHostPlan(task=self.task, asked=self.asked, episodes=episodes)
        return _wanting(self.with_changes(host_plan=said), self.task, episodes or None)

    def with_course_required(self, required: bool) -> SavedRoom:
        """Return it with what a host says of who may record; a restart that asks for the same leaves it so."""
        return self.with_changes(course_required=required)

    def requiring(self, course: bool) -> SavedRoom:
        """Return it as it begins to run where the practice course is asked for, or is not."""
        if course == self.course_asked:
            return self
        return self.with_changes(course_asked=course, course_required=course)

    def with_saved(self, number: int, good: bool) -> SavedRoom:
        """Return it with this episode counted; itself where that changes nothing.

        A later word of the same episode may only make it good: an episode in two files, or one that was verified late.
        A number that this room never gave, or that is older than all that are remembered, is not counted.
        """
        known = {one.number: one.good for one in self.counted}
        forgotten = len(known) >= _MAX_COUNTED and number < min(known)
        if not 1 <= number <= self.episodes or forgotten or known.get(number) or known.get(number) is good:
            return self
        known_now = sorted((known | {number: good}).items())[-_MAX_COUNTED:]
        return self.with_changes(
            saved=self.saved + (number not in known),
            good=self.good + good,
            counted=tuple(CountedEpisode(number=one, good=is_good) for one, is_good in known_now),
        )

    def uncounted(self) -> tuple[int, ...]:
        """Return the newest episodes of whose file nobody has told yet."""
        counted = {one.number for one in self.counted}
        first = max(1, self.episodes - _MAX_AWAITED + 1)
        return tuple(number for number in range(first, self.episodes + 1) if number not in counted)

    def holders(self) -> list[SeatHolder]:
        """Return the stored seats."""
        return [seat.holder() for seat in self.seats]

    def with_seats(self, seats: Iterable[SeatHolder]) -> SavedRoom:
        """Return it with these seats."""
        return self.with_changes(seats=tuple(_seat_record(seat) for seat in seats))

    def with_changes(self, **changes: Any) -> SavedRoom:
        """Return it with some fields changed."""
        return self.model_copy(update=changes)


def _wanting(record: SavedRoom, task: str, episodes: int | None) -> SavedRoom:
    """Return it with this plan: the same goes on, another begins anew."""
    if episodes is None:
        return record.with_changes(plan=None)
    if record.plan is not None and (record.plan.task, record.plan.episodes) == (task, episodes):
        return record
    return record.with_changes(plan=SavedPlan(task=task, episodes=episodes, good_before=record.good))


def _seat_record(seat: SeatHolder) -> SavedSeat:
    relieved = _fields(seat.relieved) if seat.relieved else None
    own = {"arm": seat.arm, "epoch": seat.epoch, "relieved": relieved, "passed_course": seat.passed_course}
    return SavedSeat.model_validate({**own, **_fields(seat.driver)})


def _fields(driver: SeatOperator) -> dict[str, str]:
    return {**asdict(driver), "operator": operator_word(driver.operator)}


def load(path: Path) -> SavedRoom | None:
    """Read a room, None where it never ran before; raises Corrupt where the file is no record of one."""
    if not path.exists():
        return None
    try:
        return SavedRoom.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise Corrupt(f"{path} is not the record of a room ({error.error_count()} faults).") from error


def load_or_put_aside(path: Path) -> SavedRoom | None:
    """Read a room; a file that is no record of one is kept under another name, and the room begins anew (None)."""
    try:
        return load(path)
    except Corrupt as error:
        aside = path.with_name(f"{path.name}.unusable-{clock.wall_ns()}")
        path.rename(aside)
        _log.error("%s It is kept as %s; the room begins anew.", error, aside)
        return None


def load_or_begin(path: Path, task: str, episodes: int | None, *, course_required: bool = False) -> SavedRoom:
    """Return the record of a room that begins to run: with this task and plan, as it was left or anew."""
    kept = load_or_put_aside(path) or SavedRoom(seed=secrets.randbits(_SEED_BITS))
    return kept.for_task(task).planned(task, episodes).requiring(course_required)


def save(path: Path, record: SavedRoom) -> None:
    """Write a room; it names holders, so the file is readable by its owner alone."""
    write_atomically(path, record.model_dump_json(indent=2).encode())
