"""Take the commands that come to a room: check them, offer them to the barrier, and say where they are too old."""

from __future__ import annotations

from collections.abc import Callable

from mart.protocol.messages import Event
from mart.sim.room import room_messages
from mart.sim.room.barrier import Barrier
from mart.sim.room.command_age import CommandAge
from mart.sim.room.command_validation import (
    CommandRejected,
    CommandRejection,
    ReceivedCommand,
    validate_command,
)
from mart.sim.room.seats import SeatTable
from mart.sim.room.ticker import Ticker


class CommandIntake:
    """Hand good commands on; what people are to know of bad ones goes to `tell`."""

    def __init__(
        self,
        barrier: Barrier,
        ticker: Ticker,
        seats: SeatTable,
        tell: Callable[[Event], None],
        control_hz: float,
    ) -> None:
        self._barrier, self._ticker, self._seats, self._tell = barrier, ticker, seats, tell
        self._age = CommandAge(control_hz)

    def take(self, payload: bytes, arm: str, at_s: float, at_wall_ns: int) -> ReceivedCommand | None:
        """Return the command that came on the key of `arm`, used or not; None where it is none, which is counted."""
        try:
            received = validate_command(payload, arm, at_s, at_wall_ns)
        except CommandRejected as error:
            self._barrier.rejected[error.reason] += 1
            return None
        tick = self._ticker.tick
        reason = self._barrier.offer(received, too_old=self._age.objection(received, tick))
        if reason is None:
            self._ticker.aim(received)
        elif reason is CommandRejection.OLD_STATE and self._age.worth_telling(received, tick):
            self._tell(room_messages.old_commands(self._seats[arm], self._age.limit_ticks))
        return received

    def world_reset(self) -> None:
        """Take note that the world begins anew: what was made from a state before that is old."""
        self._age.world_reset(self._ticker.tick)
