"""What a room keeps over a restart, a crash included: its seed, its count of episodes, its seats with their epochs."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from mart.protocol.errors import Corrupt
from mart.protocol.messages import operator_from_word, operator_word
from mart.sim.seats import SeatHolder


class SeatRecord(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    arm: str
    operator: Literal["human", "policy", "script", "hold"]
    epoch: int = Field(ge=1)
    holder_id: str
    name: str


class RoomRecord(BaseModel):
    """`episodes` is the newest number; `saved` and `good` count what the recorder reported."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    seed: int = Field(ge=0)
    episodes: int = Field(0, ge=0)
    saved: int = Field(0, ge=0)
    good: int = Field(0, ge=0)
    seats: tuple[SeatRecord, ...] = ()

    def holders(self) -> list[SeatHolder]:
        return [
            SeatHolder(seat.arm, operator_from_word(seat.operator), seat.epoch, seat.holder_id, seat.name)
            for seat in self.seats
        ]

    def with_seats(self, seats: Iterable[SeatHolder]) -> RoomRecord:
        records = tuple(
            SeatRecord.model_validate(
                {
                    "arm": seat.arm,
                    "operator": operator_word(seat.operator),
                    "epoch": seat.epoch,
                    "holder_id": seat.holder_id,
                    "name": seat.name,
                }
            )
            for seat in seats
        )
        return self.with_changes(seats=records)

    def with_changes(self, **changes: Any) -> RoomRecord:
        return self.model_copy(update=changes)


def load(path: Path) -> RoomRecord | None:
    """None where the room never ran before. Raises Corrupt where the file is no record."""
    if not path.exists():
        return None
    try:
        return RoomRecord.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise Corrupt(
            f"{path} is not the record of a room ({error.error_count()} faults); delete it to let the room begin anew."
        ) from error


def save(path: Path, record: RoomRecord) -> None:
    """Replaces the file in one step; readable by its owner alone, because it names holders."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    handle = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(handle, "w") as file:
        file.write(record.model_dump_json(indent=2))
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)
