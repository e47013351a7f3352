"""Take seats of a room for as long as a program drives them, and leave them afterwards."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence

from mart.operators.room_client import RoomClient
from mart.protocol.errors import MartError, Unavailable
from mart.protocol.holders import is_held_by
from mart.protocol.messages import OPERATOR_POLICY, Operator, RoomStatus, Seat


@contextlib.contextmanager
def claimed_seats(
    room: RoomClient, arms: Sequence[str], holder_id: str, name: str, operator: Operator = OPERATOR_POLICY
) -> Iterator[ClaimedSeats]:
    """Hold these seats for the length of the block; all are left at its end, also one that a person has just now.

    Raises Conflict where somebody else sits there, NotFound for an unknown arm, Unavailable where there is no such
    room.
    """
    with contextlib.ExitStack() as stack:
        seats = []
        for arm in arms:
            try:
                seats.append(room.claim(arm, holder_id, name, operator))
            except Unavailable:
                _leave(room, arm, holder_id)  # a room that was only late has given the seat all the same
                raise
            stack.callback(_leave, room, arm, holder_id)
        yield ClaimedSeats(holder_id, seats)


class ClaimedSeats:
    """Follow the seats of one holder: one of which a person has relieved it may come back, one given away will not."""

    def __init__(self, holder_id: str, claimed: Sequence[Seat]) -> None:
        self._holder_id = holder_id
        self._claimed = {seat.arm: seat for seat in claimed}

    def __bool__(self) -> bool:
        """Whether any seat is held still, or may come back."""
        return bool(self._claimed)

    def held(self, status: RoomStatus) -> Mapping[str, int]:
        """Return the seats to drive now, by arm with their epochs."""
        epochs: dict[str, int] = {}
        for seat in status.seats:
            claimed = self._claimed.get(seat.arm)
            if claimed is None:
                continue
            if is_held_by(seat, self._holder_id):
                epochs[seat.arm] = seat.epoch
            elif seat.epoch > claimed.epoch and seat.relieved != claimed.name:
                del self._claimed[seat.arm]
        return epochs


def _leave(room: RoomClient, arm: str, holder_id: str) -> None:
    with contextlib.suppress(MartError):  # it is another's by now, or the room is gone
        room.release(arm, holder_id)
