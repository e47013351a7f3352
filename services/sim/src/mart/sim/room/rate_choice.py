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
SMALLER = (
    0.7  # of a whole picture's time: three quarters as wide, which a quicker answer is worth to one seat
)
HELD_FACTOR = 0.98  # of real time
FIRST_WAIT_S = 60.0  # after a step down, before a step up
LONGEST_WAIT_S = 960.0


@dataclass(frozen=True)
class TickCost:
    """Tell what a room takes, as measured: medians, since what is waited for shows in the real-time factor.

    physics: seconds of one core that a simulated second takes, at any rate: substeps are about equally long. tick_s: of
    the sim besides, in each tick. picture_s: of one seat, drawn and encoded at full size. pictures: how many seats have
    one. cores: that the machine has.
    """

    physics: float
    tick_s: float
    picture_s: float
    pictures: int
    cores: int

    def use_at(self, control_hz: float) -> float:
        """Return what share of the machine this takes at a rate: of the sim's core, of a seat's, or of all cores."""
        sim, picture = self._cores_at(control_hz)
        return max(sim, SMALLER * picture, (sim + self.pictures * picture) / self.cores)

    def in_words(self, control_hz: float) -> str:
        """Return what takes most at a rate, as the end of a sentence."""
        sim, picture = self._cores_at(control_hz)
        if max(sim, SMALLER * picture) < (sim + self.pictures * picture) / self.cores:
            pictures = "1 picture" if self.pictures == 1 else f"{self.pictures} pictures"
            return f"{pictures} of {self.picture_s * 1e3:.0f} ms and the physics share {self.cores} cores"
        if SMALLER * picture >= sim:
            return f"pictures take {self.picture_s * 1e3:.0f} ms of each tick"
        return f"the physics takes {sim / control_hz * 1e3:.0f} ms of each tick"

    def _cores_at(self, control_hz: float) -> tuple[float, float]:
        """Return how many cores the sim takes at a rate, and one seat's pictures."""
        picture_s = self.picture_s if self.pictures else 0.0
        return self.physics + control_hz * self.tick_s, control_hz * picture_s


class RateChoice:
    """Hold a room's rate and say, between two episodes, which is to be next; `why` tells in words what changed it."""

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
        self.why = ""
        self._wait_s = FIRST_WAIT_S
        self._rises_after_s = float("-inf")

    def suits(self, own_rates_hz: Iterable[float]) -> bool:
        """Whether all of these can drive at the present rate, or none of the offered ones would suit them."""
        return self.control_hz in self._allowed(own_rates_hz)

    def between_episodes(
        self, cost: TickCost, held_factor: float, now_s: float, own_rates_hz: Iterable[float] = ()
    ) -> float:
        """Return the rate from now on.

        held_factor: simulated over wall time of the last episode or so, without what stalled it; 1 where there was
        none. A room in which an episode is recorded does not ask.
        """
        own = tuple(own_rates_hz)
        allowed = self._allowed(own)
        lower = [rate for rate in allowed if rate < self.control_hz]
        if self.control_hz not in allowed:  # a policy has come that this rate does not suit
            self.control_hz = lower[-1] if lower else allowed[0]
            self.why = f"who drives here acts {' and '.join(f'{one:g}' for one in own)} times a second"
        elif cost.use_at(self.control_hz) > HOLDS_BELOW:
            self._fall(lower, now_s, cost.in_words(self.control_hz))
        elif held_factor < HELD_FACTOR:
            why = f"at {self.control_hz:g} it kept {held_factor:.2f} of real time"
            self._fall(lower, now_s, why)
        elif now_s >= self._rises_after_s:
            rising = [rate for rate in allowed if rate > self.control_hz and cost.use_at(rate) <= RISES_BELOW]
            self.control_hz = max(rising, default=self.control_hz)
            self.why = "this machine has that to spare"
        return self.control_hz

    def _fall(self, lower: Sequence[float], now_s: float, why: str) -> None:
        if not lower:
            return
        self.control_hz, self.why = lower[-1], why
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
