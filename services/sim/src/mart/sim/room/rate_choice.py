"""Choose how often a second a live room ticks: the highest rate that the machine holds with its seats. Pure.

What a tick costs and how well time was kept come in, a rate comes out; it changes between episodes alone. Up needs
more to spare than staying does, and after a step down the way up is closed for a while, twice as long after each:
a rate that swings would be worse for people than a low one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mart.protocol.control_rate import OFFERED_CONTROL_HZ, ticks_for_each
from mart.protocol.errors import InvalidInput

# Shares of what the machine can do in a tick's time.
RISES_BELOW = 0.6
HOLDS_BELOW = 0.85
HELD_FACTOR = 0.97  # of real time, while nobody was waited for
FIRST_WAIT_S = 60.0  # after a step down, before a step up
LONGEST_WAIT_S = 960.0


@dataclass(frozen=True)
class TickCost:
    """Tell what one tick takes, as measured: most of the time, not on average (95th percentile).

    step_s: of the sim, which steps on one core. picture_s: of one seat, drawn and encoded. pictures: how many seats
    have one. cores: that the machine has.
    """

    step_s: float
    picture_s: float
    pictures: int
    cores: int

    def use_at(self, control_hz: float) -> float:
        """Return what share of the machine this takes at a rate: of the sim's core, of a seat's, or of all cores."""
        together_s = (self.step_s + self.pictures * self.picture_s) / self.cores
        picture_s = self.picture_s if self.pictures else 0.0
        return control_hz * max(self.step_s, picture_s, together_s)


class RateChoice:
    """Hold a room's rate and say, between two episodes, which is to be next."""

    def __init__(
        self,
        cost: TickCost,
        own_rates_hz: Iterable[float] = (),
        offered_hz: Sequence[float] = OFFERED_CONTROL_HZ,
    ) -> None:
        """Choose a first rate. own_rates_hz: of the policies that sit here; the room's must be a multiple of each."""
        self._offered_hz = tuple(sorted(offered_hz))
        allowed = self._allowed(own_rates_hz)
        self.control_hz = max(
            (rate for rate in allowed if cost.use_at(rate) <= RISES_BELOW), default=allowed[0]
        )
        self._wait_s = FIRST_WAIT_S
        self._rises_after_s = float("-inf")

    def between_episodes(
        self, cost: TickCost, held_factor: float, now_s: float, own_rates_hz: Iterable[float] = ()
    ) -> float:
        """Return the rate from now on.

        held_factor: simulated over wall time of the last episode or so, without what was waited for people; 1 where
        there was none. A room in which an episode is recorded does not ask.
        """
        allowed = self._allowed(own_rates_hz)
        lower = [rate for rate in allowed if rate < self.control_hz]
        if self.control_hz not in allowed:  # a policy has come that this rate does not suit
            self.control_hz = lower[-1] if lower else allowed[0]
        elif cost.use_at(self.control_hz) > HOLDS_BELOW or held_factor < HELD_FACTOR:
            self._fall(lower, now_s)
        elif now_s >= self._rises_after_s:
            rising = [rate for rate in allowed if rate > self.control_hz and cost.use_at(rate) <= RISES_BELOW]
            self.control_hz = max(rising, default=self.control_hz)
        return self.control_hz

    def _fall(self, lower: Sequence[float], now_s: float) -> None:
        if not lower:
            return
        self.control_hz = lower[-1]
        self._rises_after_s = now_s + self._wait_s
        self._wait_s = min(2 * self._wait_s, LONGEST_WAIT_S)

    def _allowed(self, own_rates_hz: Iterable[float]) -> list[float]:
        """Return the offered rates that suit everybody, rising; all where none does: who cannot drive says so."""
        own = tuple(own_rates_hz)
        suiting = [rate for rate in self._offered_hz if all(_suits(rate, one) for one in own)]
        return suiting or list(self._offered_hz)


def _suits(room_hz: float, own_hz: float) -> bool:
    try:
        ticks_for_each(own_hz, room_hz)
    except InvalidInput:
        return False
    return True
