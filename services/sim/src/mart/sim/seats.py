"""Who may drive which arm. Pure: requests in, a changed table or an error out.

A seat's epoch grows with every change of its holder, so commands and tokens of an earlier holder are recognised.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, NotFound
from mart.protocol.messages import (
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    Operator,
    SeatRequest,
    operator_word,
)

_FREE = (OPERATOR_HOLD, OPERATOR_SCRIPT)
_CLAIMING = (OPERATOR_HUMAN, OPERATOR_POLICY)
MAX_HOLDER_ID_CHARACTERS = 128
MAX_NAME_CHARACTERS = 40


@dataclass(frozen=True)
class SeatHolder:
    """One seat. `holder_id` is empty for hold and script; `name` is what others see."""

    arm: str
    operator: Operator = OPERATOR_HOLD
    epoch: int = 1
    holder_id: str = ""
    name: str = ""

    @property
    def free(self) -> bool:
        """Anybody may claim it."""
        return self.operator in _FREE


class SeatTaken(Conflict):
    def __init__(self, seat: SeatHolder) -> None:
        super().__init__(
            f"{seat.arm} was asked for, but {seat.name or 'someone'} ({operator_word(seat.operator)}) sits there; "
            "take another arm or wait until it is left."
        )


class SeatTable:
    """The seats of a room, in the order of its arms. Each change returns the seat as it is afterwards."""

    def __init__(self, arms: Iterable[str]) -> None:
        self._seats = {arm: SeatHolder(arm) for arm in arms}

    def __iter__(self) -> Iterator[SeatHolder]:
        return iter(self._seats.values())

    def __getitem__(self, arm: str) -> SeatHolder:
        """Raises NotFound for an arm that the room does not have."""
        if arm not in self._seats:
            raise NotFound.named("arm", arm, self._seats)
        return self._seats[arm]

    def of_holder(self, holder_id: str) -> tuple[SeatHolder, ...]:
        """The seats that this person or policy holds."""
        return tuple(seat for seat in self if seat.holder_id == holder_id) if holder_id else ()

    def of_operator(self, operator: Operator) -> tuple[SeatHolder, ...]:
        return tuple(seat for seat in self if seat.operator == operator)

    def answer(self, request: SeatRequest) -> SeatHolder:
        """Does what a request asks. Raises what claim, release and assign raise; InvalidInput for an empty one."""
        match request.WhichOneof("what"):
            case "claim":
                claim = request.claim
                return self.claim(claim.arm, claim.holder_id, claim.name, claim.operator)
            case "release":
                return self.release(request.release.arm, request.release.holder_id)
            case "assign":
                return self.assign(request.assign.arm, request.assign.operator)
        raise InvalidInput("An empty seat request was given; ask to claim, release or assign a seat.")

    def claim(self, arm: str, holder_id: str, name: str, operator: Operator) -> SeatHolder:
        """Gives a free seat to `holder_id`; its holder gets it back unchanged.

        Raises SeatTaken, InvalidInput or NotFound.
        """
        seat = self[arm]
        if operator not in _CLAIMING:
            raise InvalidInput("A seat is claimed for a human or a policy; assign it to set script or hold.")
        _require_text("holder_id", holder_id, MAX_HOLDER_ID_CHARACTERS)
        _require_text("name", name, MAX_NAME_CHARACTERS)
        if seat.holder_id == holder_id and seat.operator == operator:
            return seat
        if not seat.free and seat.holder_id != holder_id:
            raise SeatTaken(seat)
        return self._change(seat, operator, holder_id, name)

    def release(self, arm: str, holder_id: str) -> SeatHolder:
        """Leaves a seat: it goes on hold. A seat that is on hold already stays as it is. Raises Forbidden, NotFound."""
        seat = self[arm]
        if seat.operator == OPERATOR_HOLD:
            return seat
        if not holder_id or seat.holder_id != holder_id:
            raise Forbidden(f"{arm} was to be left, but it is not your seat; only its holder can leave it.")
        return self._change(seat, OPERATOR_HOLD)

    def assign(self, arm: str, operator: Operator) -> SeatHolder:
        """Sets a free seat to script or hold. Raises SeatTaken, InvalidInput, NotFound."""
        seat = self[arm]
        if operator not in _FREE:
            raise InvalidInput("A seat is assigned to script or hold; claim it for a human or a policy.")
        if not seat.free:
            raise SeatTaken(seat)
        return seat if seat.operator == operator else self._change(seat, operator)

    def free(self, arm: str) -> SeatHolder:
        """Takes a seat from a holder who went silent."""
        return self._change(self[arm], OPERATOR_HOLD)

    def restore(self, seats: Iterable[SeatHolder]) -> None:
        """Takes over the kept seats of arms that still exist."""
        self._seats.update((seat.arm, seat) for seat in seats if seat.arm in self._seats)

    def _change(
        self, seat: SeatHolder, operator: Operator, holder_id: str = "", name: str = ""
    ) -> SeatHolder:
        changed = replace(seat, operator=operator, epoch=seat.epoch + 1, holder_id=holder_id, name=name)
        self._seats[seat.arm] = changed
        return changed


def _require_text(what: str, value: str, limit: int) -> None:
    if not 0 < len(value) <= limit or not value.isprintable():
        raise InvalidInput(f"A {what} of {len(value)} characters was given; use 1 to {limit} printable ones.")
