"""Tell which seats have a process, and which gateway owes it. Pure, and light: a gateway imports nothing heavy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mart.protocol.gateway_choice import gateway_of
from mart.protocol.messages import OPERATOR_HUMAN, OPERATOR_POLICY, RoomStatus

SERVED_OPERATORS = (OPERATOR_HUMAN, OPERATOR_POLICY)  # whose seats have a process, and with it a picture
FORGOTTEN_AFTER_SWEEPS = 15
GONE_AFTER_SWEEPS = 5  # without its token: a sim that is started anew, or a router, takes it for seconds


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


class _ToldAndAsked:
    """Keep whose tokens exist, by being told and by asking: each may miss what the other has."""

    def __init__(self) -> None:
        self.names: frozenset[str] = frozenset()
        self._asked: frozenset[str] | None = None

    def tell(self, name: str, alive: bool) -> None:
        self.names = self.names | {name} if alive else self.names - {name}
        self._asked = None  # an answer that is on its way may be older than this

    def ask(self, names: Iterable[str]) -> None:
        asked = frozenset(names)
        if asked == self._asked:  # two answers in a row agree
            self.names = asked
        self._asked = asked


class SeatRegister:
    """Keep account of every room's served seats, and of which gateway serves each.

    Rooms repeat their status, so a lost one is made good by the next. A room whose sim has no liveliness token is not
    listened to; one whose token is gone for GONE_AFTER_SWEEPS sweeps is forgotten, and so is one that says nothing for
    FORGOTTEN_AFTER_SWEEPS.
    """

    def __init__(self, gateway: str) -> None:
        """Keep a register for the gateway of this name, which is always among those that serve."""
        self._gateway = gateway
        self._gateways = _ToldAndAsked()
        self._live = _ToldAndAsked()
        self._gone_sweeps: dict[str, int] = {}
        self._epochs: dict[str, dict[SeatAddress, int]] = {}  # by room, as last told
        self._silent_sweeps: dict[str, int] = {}

    def on_status(self, status: RoomStatus) -> None:
        """Take what a room says of its seats, where it has a sim that is alive."""
        if status.room not in self._live.names:
            return
        self._epochs[status.room] = served_epochs(status)
        self._silent_sweeps[status.room] = 0

    def on_gateway(self, name: str, alive: bool) -> None:
        """Take the news that a gateway came or went."""
        self._gateways.tell(name, alive)

    def on_gateways_asked(self, names: Iterable[str]) -> None:
        """Take the answer to who is alive: news may be lost. It counts once two answers in a row agree."""
        self._gateways.ask(names)

    def on_room(self, name: str, alive: bool) -> None:
        """Take the news that the sim of a room came or went."""
        self._live.tell(name, alive)

    def on_rooms_asked(self, names: Iterable[str]) -> None:
        """Take the answer to whose sims are alive; it counts as for gateways."""
        self._live.ask(names)

    def sweep(self) -> None:
        """Note that a period went by. Sweeps are counted, not seconds: a gateway that was frozen forgets nobody."""
        for room in list(self._silent_sweeps):
            self._silent_sweeps[room] += 1
            gone = 0 if room in self._live.names else self._gone_sweeps.get(room, 0) + 1
            self._gone_sweeps[room] = gone
            if self._silent_sweeps[room] > FORGOTTEN_AFTER_SWEEPS or gone > GONE_AFTER_SWEEPS:
                del self._silent_sweeps[room], self._epochs[room], self._gone_sweeps[room]

    def epoch(self, seat: SeatAddress) -> int | None:
        """Return the newest epoch that was told of this seat; None where it is not served."""
        return self._epochs.get(seat.room, {}).get(seat)

    def mine(self) -> frozenset[SeatAddress]:
        """Return the seats that this gateway serves."""
        serving = self._gateways.names | {self._gateway}
        seats = (seat for epochs in self._epochs.values() for seat in epochs)
        return frozenset(s for s in seats if gateway_of(serving, s.room, s.arm) == self._gateway)
