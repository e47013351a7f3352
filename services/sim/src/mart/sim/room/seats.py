"""Decide who may drive which arm. Pure: requests in, a changed table or an error out.

A seat's epoch grows with every change of its holder, so commands and tokens of an earlier holder are recognised.
Machines (scripts and policies) make room for people: whoever claims a machine's seat takes over from it, also in
mid-episode, and may hand the seat back to the same machine.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

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

_CLAIMING = (OPERATOR_HUMAN, OPERATOR_POLICY)
MAX_HOLDER_ID_CHARACTERS = 128
MAX_NAME_CHARACTERS = 64
_POLICY_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


@dataclass(frozen=True)
class SeatOperator:
    """Tell who drives; `name` is what others see, `policy` names a promoted policy.

    `holder_id` is empty for hold, script and a promoted policy, which nobody in particular brought.
    """

    operator: Operator = OPERATOR_HOLD
    holder_id: str = ""
    name: str = ""
    policy: str = ""

    @property
    def is_machine(self) -> bool:
        """Whether it is a script or a policy."""
        return self.operator in (OPERATOR_SCRIPT, OPERATOR_POLICY)

    @property
    def called(self) -> str:
        """Return what people call it: its name, or what it is."""
        return self.name or operator_word(self.operator)


NOBODY = SeatOperator()


@dataclass(frozen=True)
class SeatHolder:
    """Hold one seat. `relieved`: the machine that its human took over from, if any.

    passed_course: what was said of its human; no change of it makes another holder.
    """

    arm: str
    epoch: int = 1
    driver: SeatOperator = NOBODY
    relieved: SeatOperator | None = None
    passed_course: bool = field(default=False, compare=False)

    @property
    def operator(self) -> Operator:
        """Which kind of operator drives."""
        return self.driver.operator

    @property
    def holder_id(self) -> str:
        """Who holds the seat, empty where nobody in particular does."""
        return self.driver.holder_id

    @property
    def name(self) -> str:
        """What others see."""
        return self.driver.name


class SeatTaken(Conflict):
    """Refuse a seat that somebody else holds."""

    def __init__(self, seat: SeatHolder) -> None:
        super().__init__(
            f"{seat.arm} was asked for, but {seat.name or 'someone'} ({operator_word(seat.operator)}) sits there; "
            "take another arm or wait until it is left."
        )


class SeatTable:
    """Hold the seats of a room, in the order of its arms. Each change returns the seat as it is afterwards."""

    def __init__(self, arms: Iterable[str]) -> None:
        self._seats = {arm: SeatHolder(arm) for arm in arms}

    def __iter__(self) -> Iterator[SeatHolder]:
        return iter(self._seats.values())

    def __getitem__(self, arm: str) -> SeatHolder:
        """Return the seat of `arm`; raises NotFound for an arm that the room does not have."""
        if arm not in self._seats:
            raise NotFound.named("arm", arm, self._seats)
        return self._seats[arm]

    def of_holder(self, holder_id: str) -> tuple[SeatHolder, ...]:
        """Return the seats that this person or policy holds."""
        return tuple(seat for seat in self if seat.holder_id == holder_id) if holder_id else ()

    def of_operator(self, operator: Operator) -> tuple[SeatHolder, ...]:
        """Return the seats that this kind of operator drives."""
        return tuple(seat for seat in self if seat.operator == operator)

    def answer(self, request: SeatRequest) -> SeatHolder:
        """Do what a request asks. Raises what the methods for it raise; InvalidInput for an empty one."""
        match request.WhichOneof("what"):
            case "claim":
                claim = request.claim
                seat = self.claim(claim.arm, claim.holder_id, claim.name, claim.operator)
                self._seats[seat.arm] = replace(seat, passed_course=claim.passed_course)
                return self._seats[seat.arm]
            case "release":
                return self.release(request.release.arm, request.release.holder_id)
            case "assign":
                wanted = request.assign
                return self.assign(wanted.arm, wanted.operator, wanted.policy, name=wanted.name)
            case "hand_back":
                return self.hand_back(request.hand_back.arm, request.hand_back.holder_id)
            case "free":
                require_name(request.free.name)
                seat = self[request.free.arm]
                return self.free(seat.arm) if seat.operator != OPERATOR_HOLD else seat
        raise InvalidInput(
            "An empty seat request was given; ask to claim, release, assign, hand back or free a seat."
        )

    def claim(self, arm: str, holder_id: str, name: str, operator: Operator) -> SeatHolder:
        """Give a seat that no other holds to `holder_id`; its holder gets it back unchanged.

        A human takes over from any machine. A policy comes in where nobody or a script sits, or in place of a promoted
        policy. Raises SeatTaken, InvalidInput or NotFound.
        """
        seat = self[arm]
        if operator not in _CLAIMING:
            raise InvalidInput("A seat is claimed for a human or a policy; assign it to set script or hold.")
        _require_text("holder_id", holder_id, MAX_HOLDER_ID_CHARACTERS)
        require_name(name)
        if seat.holder_id == holder_id and seat.operator == operator:
            return seat
        takes_over = operator == OPERATOR_HUMAN and seat.driver.is_machine
        if seat.holder_id not in ("", holder_id) and not takes_over:
            raise SeatTaken(seat)
        return self._change(
            seat, SeatOperator(operator, holder_id, name), relieved=seat.driver if takes_over else None
        )

    def hand_back(self, arm: str, holder_id: str) -> SeatHolder:
        """Give a seat back to the machine that its human took over from. Raises Forbidden, Conflict, NotFound."""
        seat = self[arm]
        self._require_holder(seat, holder_id)
        if seat.relieved is None:
            raise Conflict(f"{arm} was to be handed back, but nobody was relieved there; leave it instead.")
        return self._change(seat, seat.relieved)

    def release(self, arm: str, holder_id: str) -> SeatHolder:
        """Put a left seat on hold; one that is on hold already stays as it is. Raises Forbidden, NotFound."""
        seat = self[arm]
        if seat.operator == OPERATOR_HOLD:
            return seat
        self._require_holder(seat, holder_id)
        return self._change(seat, NOBODY)

    def assign(self, arm: str, operator: Operator, policy: str = "", *, name: str = "") -> SeatHolder:
        """Set a seat that no human holds to script, hold or a promoted policy. name: of a script, for files.

        Raises SeatTaken, InvalidInput or NotFound.
        """
        seat = self[arm]
        if operator not in (OPERATOR_HOLD, OPERATOR_SCRIPT, OPERATOR_POLICY):
            raise InvalidInput("A seat is assigned to script, policy or hold; claim it for a human.")
        if (operator == OPERATOR_POLICY) != bool(policy):
            raise InvalidInput(
                "A seat was assigned with or without a policy's name where it should be otherwise."
            )
        if seat.operator == OPERATOR_HUMAN:
            raise SeatTaken(seat)
        if policy and not _POLICY_NAME.fullmatch(policy):
            raise InvalidInput(
                f"{policy[:80]!r} cannot name a promoted policy; use 1 to 64 lower-case letters, digits, '-' or '_'."
            )
        if name:
            require_name(name)
        driver = SeatOperator(operator, name=policy or name, policy=policy)
        return seat if seat.driver == driver else self._change(seat, driver)

    def free(self, arm: str) -> SeatHolder:
        """Take a seat from a holder who went silent, or for a host."""
        return self._change(self[arm], NOBODY)

    def restore(self, seats: Iterable[SeatHolder]) -> None:
        """Take over the kept seats of arms that still exist."""
        self._seats.update((seat.arm, seat) for seat in seats if seat.arm in self._seats)

    def _require_holder(self, seat: SeatHolder, holder_id: str) -> None:
        if not holder_id or seat.holder_id != holder_id:
            raise Forbidden(f"{seat.arm} is not your seat; only its holder can leave it or hand it back.")

    def _change(
        self, seat: SeatHolder, driver: SeatOperator, relieved: SeatOperator | None = None
    ) -> SeatHolder:
        changed = SeatHolder(seat.arm, seat.epoch + 1, driver, relieved)
        self._seats[seat.arm] = changed
        return changed


def require_name(name: str) -> None:
    """Raise InvalidInput where a person's name cannot be shown to others."""
    _require_text("name", name, MAX_NAME_CHARACTERS)


def _require_text(what: str, value: str, limit: int) -> None:
    if not 0 < len(value) <= limit or not value.isprintable():
        raise InvalidInput(f"A {what} of {len(value)} characters was given; use 1 to {limit} printable ones.")
