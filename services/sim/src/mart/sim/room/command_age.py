"""Tell commands that were made from too old a state or waited on their way, and when to say so to people. Pure."""

from __future__ import annotations

from mart.runtime.queueing_delay import QueueingDelay
from mart.sim.room.command_validation import CommandRejection, ReceivedCommand

MAX_AGE_S = 1.0  # simulated; and at least so many ticks:
MIN_AGE_TICKS = 5
TELL_EVERY_S = 10.0
MAX_WAIT_S = (
    0.5  # beyond the quickest of the last seconds: while a link is broken the world stands, and no state ages
)


class CommandAge:
    """Know how old the state may be that a command was made from: whoever does not hear the room drives blind."""

    def __init__(self, control_hz: float) -> None:
        self.limit_ticks = max(MIN_AGE_TICKS, round(MAX_AGE_S * control_hz))
        self._reset_tick = 0
        self._told_s: dict[str, float] = {}  # by arm
        self._delays: dict[str, tuple[int, QueueingDelay]] = {}  # by arm, of the epoch heard last

    def world_reset(self, tick: int) -> None:
        """Take the tick of the state after a reset: what was made from earlier ones is void."""
        self._reset_tick = tick

    def objection(self, received: ReceivedCommand, tick: int) -> CommandRejection | None:
        """Tell what speaks against a command for its age; None where nothing does, or it does not tell its age.

        A tick that has not been is one of an earlier run of the sim.
        """
        made_from = received.command.state_tick
        waited_s = self._waited_s(received)
        if made_from and not max(self._reset_tick, tick - self.limit_ticks) <= made_from <= tick:
            return CommandRejection.OLD_STATE
        return CommandRejection.WAITED if waited_s > MAX_WAIT_S else None

    def _waited_s(self, received: ReceivedCommand) -> float:
        sent_ns = received.command.stamps.sent_ns
        if not sent_ns:
            return 0.0
        epoch, delay = self._delays.get(received.arm, (received.seat_epoch, QueueingDelay()))
        if epoch != received.seat_epoch:
            delay = QueueingDelay()  # of another sender, whose clock is its own
        self._delays[received.arm] = (received.seat_epoch, delay)
        return delay.waited_s(sent_ns * 1e-9, received.at_wall_ns * 1e-9)

    def worth_telling(self, received: ReceivedCommand, tick: int) -> bool:
        """Tell whether people should hear of this refused command: one of the same world, and not again and again."""
        if not self._reset_tick <= received.command.state_tick <= tick:
            return False
        if received.at_s - self._told_s.get(received.arm, float("-inf")) < TELL_EVERY_S:
            return False
        self._told_s[received.arm] = received.at_s
        return True
