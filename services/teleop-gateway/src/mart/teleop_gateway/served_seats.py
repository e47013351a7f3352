"""Tell which seats have a process, and which gateway owes it. Pure, and light: a gateway imports nothing heavy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mart.protocol.gateway_choice import gateway_of
from mart.protocol.messages import OPERATOR_HUMAN, OPERATOR_POLICY, RoomStatus

SERVED_OPERATORS = (OPERATOR_HUMAN, OPERATOR_POLICY)  # whose seats have a process, and with it a picture
FORGOTTEN_AFTER_SWEEPS = 15


@dataclass(frozen=True)
class SeatAddress:
    """Name one seat: an arm in a room."""

    room: str
    arm: str

    @property
    def id(self) -> str:
        """The id in the liveliness token of the seat's process."""
        return f"{self.room}-{self.arm}"


def served_epochs(status: RoomStatus) -> dict[SeatAddress, int]:
    """Return the epoch of every seat of this room that has a process."""
    return {
        SeatAddress(status.room, seat.arm): seat.epoch
        for seat in status.seats
        if seat.operator in SERVED_OPERATORS
    }


class SeatRegister:
    """Keep account of every room's served seats, and of which gateway serves each.

    Rooms repeat their status, so a lost one is made good by the next; a room that falls silent for good is forgotten
    after FORGOTTEN_AFTER_SWEEPS sweeps without a word: nothing else says that a room was closed.
    """

    def __init__(self, gateway: str) -> None:
        """Keep a register for the gateway of this name, which is always among those that serve."""
        self._gateway = gateway
        self._gateways = frozenset({gateway})
        self._asked: frozenset[str] | None = None
        self._epochs: dict[str, dict[SeatAddress, int]] = {}  # by room, as last told
        self._silent_sweeps: dict[str, int] = {}

    def on_status(self, status: RoomStatus) -> None:
        """Take what a room says of its seats."""
        self._epochs[status.room] = served_epochs(status)
        self._silent_sweeps[status.room] = 0

    def on_gateway(self, name: str, alive: bool) -> None:
        """Take the news that a gateway came or went."""
        others = self._gateways | {name} if alive else self._gateways - {name}
        self._gateways = others | {self._gateway}
        self._asked = None  # an answer that is on its way may be older than this

    def on_gateways_asked(self, names: Iterable[str]) -> None:
        """Take the answer to who is alive: news may be lost. It counts once two answers in a row agree."""
        asked = frozenset(names)
        if asked == self._asked:
            self._gateways = asked | {self._gateway}
        self._asked = asked

    def sweep(self) -> None:
        """Note that a period went by. Sweeps are counted, not seconds: a gateway that was frozen forgets nobody."""
        for room in list(self._silent_sweeps):
            self._silent_sweeps[room] += 1
            if self._silent_sweeps[room] > FORGOTTEN_AFTER_SWEEPS:
                del self._silent_sweeps[room], self._epochs[room]

    def epoch(self, seat: SeatAddress) -> int | None:
        """Return the newest epoch that was told of this seat; None where it is not served."""
        return self._epochs.get(seat.room, {}).get(seat)

    def mine(self) -> frozenset[SeatAddress]:
        """Return the seats that this gateway serves."""
        seats = (seat for epochs in self._epochs.values() for seat in epochs)
        return frozenset(s for s in seats if gateway_of(self._gateways, s.room, s.arm) == self._gateway)
