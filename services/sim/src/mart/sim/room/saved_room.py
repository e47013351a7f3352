"""What a room keeps over a restart, a crash included: its seed, its count of episodes, its seats with their epochs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from mart.protocol.errors import Corrupt
from mart.protocol.messages import operator_from_word, operator_word
from mart.runtime.atomic_file import write_atomically
from mart.sim.room.seats import Driver, SeatHolder


class SavedDriver(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    operator: Literal["human", "policy", "script", "hold"]
    holder_id: str
    name: str
    policy: str = ""

    def driver(self) -> Driver:
        return Driver(operator_from_word(self.operator), self.holder_id, self.name, self.policy)


class SavedSeat(SavedDriver):
    arm: str
    epoch: int = Field(ge=1)
    relieved: SavedDriver | None = None

    def holder(self) -> SeatHolder:
        return SeatHolder(
            self.arm, self.epoch, self.driver(), self.relieved.driver() if self.relieved else None
        )


class SavedPlan(BaseModel):
    """So many good `episodes` of `task` are wanted; `good_before`: the room's good ones when that was said."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    task: str
    episodes: int = Field(ge=1)
    good_before: int = Field(ge=0)


class SavedRoom(BaseModel):
    """`episodes` is the newest number; `saved` and `good` count what the recorder reported."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    seed: int = Field(ge=0)
    episodes: int = Field(0, ge=0)
    saved: int = Field(0, ge=0)
    good: int = Field(0, ge=0)
    seats: tuple[SavedSeat, ...] = ()
    plan: SavedPlan | None = None

    def planned(self, task: str, episodes: int | None) -> SavedRoom:
        """With so many good episodes of this task wanted: goes on with the same plan, begins anew with another."""
        if episodes is None:
            return self.with_changes(plan=None)
        if self.plan is not None and (self.plan.task, self.plan.episodes) == (task, episodes):
            return self
        return self.with_changes(plan=SavedPlan(task=task, episodes=episodes, good_before=self.good))

    def holders(self) -> list[SeatHolder]:
        return [seat.holder() for seat in self.seats]

    def with_seats(self, seats: Iterable[SeatHolder]) -> SavedRoom:
        return self.with_changes(seats=tuple(_seat_record(seat) for seat in seats))

    def with_changes(self, **changes: Any) -> SavedRoom:
        return self.model_copy(update=changes)


def _seat_record(seat: SeatHolder) -> SavedSeat:
    relieved = _fields(seat.relieved) if seat.relieved else None
    return SavedSeat.model_validate(
        {"arm": seat.arm, "epoch": seat.epoch, "relieved": relieved, **_fields(seat.driver)}
    )


def _fields(driver: Driver) -> dict[str, str]:
    return {**asdict(driver), "operator": operator_word(driver.operator)}


def load(path: Path) -> SavedRoom | None:
    """None where the room never ran before. Raises Corrupt where the file is no record."""
    if not path.exists():
        return None
    try:
        return SavedRoom.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise Corrupt(
            f"{path} is not the record of a room ({error.error_count()} faults); delete it to let the room begin anew."
        ) from error


def save(path: Path, record: SavedRoom) -> None:
    """It names holders, so it is readable by its owner alone."""
    write_atomically(path, record.model_dump_json(indent=2).encode())
