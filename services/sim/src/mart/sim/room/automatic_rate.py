"""Know when a room whose rate nobody gave is to tick at another, and at which. Pure: what the room says comes in.

It changes between episodes alone: after one, in the moment in which practice begins with a fresh world, or in practice
where nobody has held an arm for some seconds and nobody is ready. Whoever drives is never interrupted.
"""

from __future__ import annotations

from dataclasses import dataclass

from mart.protocol.control_rate import LEARNING_CONTROL_HZ
from mart.protocol.messages import (
    EPISODE_PHASE_PRACTICE,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    RoomStatus,
    Seat,
    State,
)
from mart.sim.room.barrier import STALLED_AFTER_S
from mart.sim.room.rate_choice import RateChoice, TickCost
from mart.sim.room.time_kept import TimeKept

# Of one seat without a graphics card, until seats have said what theirs take: 11.5 to 18 ms were measured.
ASSUMED_PICTURE_S = 0.016
LONGEST_PICTURE_S = 2.0  # that is believed
LOOK_EVERY_S = 5.0  # in practice
IDLE_S = 3.0  # with no arm in any hand; who lets go only to reach farther goes on at once


@dataclass(frozen=True)
class SimCost:
    """Hold what the sim takes by itself, and how many cores there are; see `TickCost`."""

    physics: float
    tick_s: float
    cores: int


class AutomaticRate:
    """Follow what a room says of itself, and its seats of their pictures; `control_hz` is the room's present rate."""

    def __init__(
        self,
        sim: SimCost,
        arms: int,
        now_s: float,
        *,
        pace: float = 1.0,
        picture_s: float = 0.0,
        policies: bool = False,
    ) -> None:
        """Choose a first rate. picture_s: what a picture took in this room before; 0: nobody has said.

        pace: the real-time factor that the room may reach at most. policies: whether any drives here.
        """
        self._pace = pace
        self._sim, self._arms = sim, arms
        self._policies = policies
        self._pictures_s: dict[str, float] = {}
        self._known_picture_s = picture_s or ASSUMED_PICTURE_S
        self._status = RoomStatus()
        self._is_fresh, self._held_s = False, float("-inf")
        self._look_s = now_s + LOOK_EVERY_S
        self._choice = RateChoice(self._cost(), self._own_rates_hz())
        self._kept = TimeKept(STALLED_AFTER_S)

    @property
    def control_hz(self) -> float:
        """The rate that the room has, or is to have once `change` has said so."""
        return self._choice.control_hz

    @property
    def picture_s(self) -> float:
        """What a seat's picture takes: the slowest of those that are drawn, or the newest that was heard of."""
        drawn = self._drawn_arms()
        return max((s for arm, s in self._pictures_s.items() if arm in drawn), default=self._known_picture_s)

    def see_state(self, state: State, now_s: float) -> None:
        """Take that the room told a state now: after a tick, or after a reset, where nothing was due."""
        if not state.stamps.due_ns:
            self._kept.interrupt()
            return
        self._is_fresh = False
        self._kept.ticked(now_s)

    def see_status(self, status: RoomStatus, now_s: float) -> None:
        """Take how the room stands now."""
        before = self._status.episode.phase
        practises = status.episode.phase == EPISODE_PHASE_PRACTICE
        self._is_fresh |= practises and bool(before) and before != EPISODE_PHASE_PRACTICE
        self._status = status
        self._policies = any(_may_be_policy(seat) for seat in status.seats)
        if any(seat.operator == OPERATOR_HUMAN and seat.engaged for seat in status.seats):
            self._held_s = now_s

    def see_seat(self, seat: Seat) -> None:
        """Take that a seat has changed, before the status says so."""
        self._policies |= _may_be_policy(seat)

    def see_picture(self, arm: str, picture_s: float) -> None:
        """Take what a seat said its picture takes, drawn and encoded at full size."""
        known = any(seat.arm == arm for seat in self._status.seats)
        if known and 0.0 < picture_s <= LONGEST_PICTURE_S:
            self._pictures_s[arm] = self._known_picture_s = picture_s

    def may_change(self, now_s: float) -> bool:
        """Tell whether it is worth to ask `change`, with the room's present status seen before."""
        if not self._is_between_episodes():
            return False
        if self._is_fresh or not self._choice.suits(self._own_rates_hz()):
            return True
        return now_s >= self._look_s and now_s - self._held_s >= IDLE_S

    def change(self, now_s: float) -> str | None:
        """Say in words that the room is to tick at another rate from now on, `control_hz`; None where it is not."""
        if not self.may_change(now_s):
            return None
        before_hz = self._choice.control_hz
        held = self._held_factor()
        after_hz = self._choice.between_episodes(self._cost(), held, now_s, self._own_rates_hz())
        self._look_s = now_s + LOOK_EVERY_S
        self._is_fresh = False
        if after_hz == before_hz:
            return None
        self._kept.forget()
        return f"The room now ticks {after_hz:g} times a second: {self._choice.why}."

    def _is_between_episodes(self) -> bool:
        """Whether neither an episode, nor a countdown, nor a wish for one, nor a stop is on."""
        status = self._status
        practises = status.episode.phase == EPISODE_PHASE_PRACTICE
        return practises and not status.HasField("stop") and not any(seat.ready for seat in status.seats)

    def _drawn_arms(self) -> list[str]:
        return [s.arm for s in self._status.seats if s.operator in (OPERATOR_HUMAN, OPERATOR_POLICY)]

    def _cost(self) -> TickCost:
        pictures = len(self._drawn_arms()) or self._arms  # who may come
        return TickCost(self._sim.physics, self._sim.tick_s, self.picture_s, pictures, self._sim.cores)

    def _held_factor(self) -> float:
        """Return how much of its pace the room kept since it was looked at last; 1 where there is little to tell."""
        ticks_per_s = self._kept.ticks_per_s()
        return 1.0 if ticks_per_s is None else min(1.0, ticks_per_s / self.control_hz / self._pace)

    def _own_rates_hz(self) -> tuple[float, ...]:
        return (LEARNING_CONTROL_HZ,) if self._policies else ()


def _may_be_policy(seat: Seat) -> bool:
    """Whether a policy drives, or may drive again when its seat is handed back; its own rate is the usual one."""
    return OPERATOR_POLICY in (seat.operator, seat.relieved_operator)
