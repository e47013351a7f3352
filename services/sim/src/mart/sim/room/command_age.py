"""Tell commands that were made from too old a state, and when to say so to people. Pure."""

from __future__ import annotations

from mart.sim.room.command_validation import ReceivedCommand

MAX_AGE_S = 1.0  # simulated; and at least so many ticks:
MIN_AGE_TICKS = 5
TELL_EVERY_S = 10.0


class CommandAge:
    """Know how old the state may be that a command was made from: whoever does not hear the room drives blind."""

    def __init__(self, control_hz: float) -> None:
        self.limit_ticks = max(MIN_AGE_TICKS, round(MAX_AGE_S * control_hz))
        self._reset_tick = 0
        self._told_s: dict[str, float] = {}  # by arm

    def world_reset(self, tick: int) -> None:
        """Take the tick of the state after a reset: what was made from earlier ones is void."""
        self._reset_tick = tick

    def allows(self, received: ReceivedCommand, tick: int) -> bool:
        """Tell whether the command was made from a state of this world that is new enough, or does not say from which.

        A tick that has not been is one of an earlier run of the sim.
        """
        made_from = received.command.state_tick
        return made_from == 0 or max(self._reset_tick, tick - self.limit_ticks) <= made_from <= tick

    def worth_telling(self, received: ReceivedCommand, tick: int) -> bool:
        """Tell whether people should hear of this refused command: one of the same world, and not again and again."""
        if not self._reset_tick <= received.command.state_tick <= tick:
            return False
        if received.at_s - self._told_s.get(received.arm, float("-inf")) < TELL_EVERY_S:
            return False
        self._told_s[received.arm] = received.at_s
        return True
