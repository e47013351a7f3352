"""Advance the world only when every operator has given a new command: the barrier.

A pure state machine: commands, seats and `now` in, decisions out. No bus, no threads, no clock. Times are seconds on
one monotonic clock.

A tick fires when every seat that is not `hold` has a command newer than the one used before and the pace allows it.
The newest command wins by its sequence; nothing is queued. A seat without a command for `STALLED_AFTER_S` stalls the
room (everyone is told who is being waited for); after `PAUSED_AFTER_S` the room is paused and no tick fires until that
seat speaks again or changes; after `FREED_AFTER_S` a human's or policy's seat is given up. Whoever held a seat before a
restart and has not spoken since is away: the seat is kept for as long, but in practice its arm holds and nobody waits.
An emergency stop latches: from the first command that says so after one that did not, no tick fires until somebody lets
go, whatever becomes of that seat.

A room whose seats are all `hold` has nobody to wait for: the rule is met by nobody's missing, and the world lives on
at its pace, with its arms holding.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    BARRIER_PHASE_STOPPED,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    BarrierPhase,
    Operator,
)
from mart.sim.room.command_validation import CommandRejection, ReceivedCommand
from mart.sim.room.pacing import Pace

STALLED_AFTER_S = 0.25
PAUSED_AFTER_S = 3.0
FREED_AFTER_S = 30.0
_GIVEN_UP = (OPERATOR_HUMAN, OPERATOR_POLICY)  # whose seats; scripts come with the platform
# A gateway's process that starts anew counts on from the clock's milliseconds; this is 49 days of them. Whoever could
# leap further would leave the holder no numbers.
MAX_SEQUENCE_LEAP = 2**32


@dataclass(frozen=True)
class TickInputs:
    """Hold what a tick that fires now is stepped with.

    commands: the newest command of every arm that is not on hold. straggler: the arm that completed the barrier last,
    None where nobody drives; late_s: how long the tick waited for it beyond the pace. resumed: the world had stood
    still until now, paused, stopped, or for the first command of a new holder.
    """

    commands: Mapping[str, ReceivedCommand]
    due_s: float
    straggler: str | None
    late_s: float
    resumed: bool = False


@dataclass(frozen=True)
class Decision:
    """Tell what holds now. Ask again at `next_s`, or when a command arrives, whichever is first.

    waiting_for: (arm, for how many seconds); the arms without a command, or the one whose emergency stop is on.
    silent: arms whose seat is to be given up.
    """

    phase: BarrierPhase
    waiting_for: tuple[tuple[str, float], ...]
    silent: tuple[str, ...]
    inputs: TickInputs | None
    next_s: float

    @property
    def stands(self) -> bool:
        """Whether no tick fires, because somebody is missing for long or an emergency stop is on."""
        return self.phase in (BARRIER_PHASE_PAUSED, BARRIER_PHASE_STOPPED)


@dataclass
class _SeatState:
    """Hold what the barrier knows of one seat."""

    operator: Operator
    epoch: int
    heard_s: float  # when a command was last accepted, or when the seat got its holder
    newest: ReceivedCommand | None = None
    last_sequence: int = -1  # of the newest accepted command
    unused: bool = False  # the newest command has not moved the world yet
    away: bool = False  # held since before a restart, and not a word since
    complete_s: float = 0.0  # when the first unused command arrived
    begun: bool = False  # a command has moved the world

    @property
    def driven(self) -> bool:
        return self.operator != OPERATOR_HOLD


class Barrier:
    """Decide when the world ticks; `arms` start on hold with epoch 0, `seat` puts operators in."""

    def __init__(self, arms: Iterable[str], period_s: float, now_s: float) -> None:
        self.pace = Pace(period_s, now_s)
        self.rejected: Counter[CommandRejection] = Counter()
        self._seats = {arm: _SeatState(OPERATOR_HOLD, 0, now_s) for arm in arms}
        self._driven: dict[str, _SeatState] = {}  # those of them that are not on hold
        self._stop: tuple[str, float] | None = None  # arm, since when
        self._stood = False  # paused or stopped since the last tick

    def seat(self, arm: str, operator: Operator, epoch: int, now_s: float, *, restored: bool = False) -> None:
        """Give a seat to a new holder: what the old one said no longer counts.

        restored: to the one who held it before a restart; a person or a policy is away until their first command.
        """
        away = restored and operator in _GIVEN_UP
        self._seats[arm] = _SeatState(operator, epoch, now_s, away=away)
        self._driven = {arm: seat for arm, seat in self._seats.items() if seat.driven}

    def offer(
        self, received: ReceivedCommand, *, too_old: CommandRejection | None = None
    ) -> CommandRejection | None:
        """Take a command, or return why not; rejections are counted in `rejected`.

        `too_old`: why its age speaks against it. One that is too old stops the room all the same.
        """
        objection = self._objection(received)
        if objection is None and self._presses_stop(received):
            self.stop(received.arm, received.at_s)
        reason = objection or too_old
        if reason is not None:
            self.rejected[reason] += 1
            return reason
        seat = self._seats[received.arm]
        if not seat.unused:
            seat.complete_s = received.at_s
        seat.newest, seat.unused = received, True
        seat.last_sequence = received.sequence
        seat.heard_s = received.at_s
        seat.away = False
        return None

    @property
    def stopped(self) -> bool:
        """Whether an emergency stop is on."""
        return self._stop is not None

    def stop(self, arm: str, now_s: float) -> None:
        """Let no tick fire until `let_go`. `arm`: where it was pressed, empty for nowhere in particular."""
        if self._stop is None:
            self._stop = (arm, now_s)

    def let_go(self) -> None:
        """Let ticks fire again: everybody's newest command counts."""
        self._stop = None

    def newest(self, arm: str) -> ReceivedCommand | None:
        """Return the newest accepted command of the arm's present operator, used or not."""
        return self._seats[arm].newest

    def kept_s(self, arm: str, now_s: float) -> float:
        """Return for how long a seat is still kept for a holder who is away or has paused the room, else 0."""
        seat = self._seats[arm]
        silence_s = now_s - seat.heard_s
        if seat.operator not in _GIVEN_UP or not (seat.away or silence_s >= PAUSED_AFTER_S):
            return 0.0
        return max(0.0, FREED_AFTER_S - silence_s)

    def restart(self, now_s: float) -> None:
        """Void the commands given for the world before a reset, and begin the pace anew."""
        for seat in self._seats.values():
            seat.unused = False
        self.pace.restart(now_s)

    def advance(self, now_s: float, gate_open: bool, *, awaits_away: bool = True) -> Decision:
        """Decide. Where a tick fires, its commands count as used.

        gate_open: the episode lets the world run. awaits_away: whoever is away is waited for like anybody.
        """
        awaited = {arm: seat for arm, seat in self._driven.items() if awaits_away or not seat.away}
        phase, waiting_for = self._phase(awaited, now_s)
        self._stood |= phase in (BARRIER_PHASE_PAUSED, BARRIER_PHASE_STOPPED)
        world_may_run = gate_open and phase in (BARRIER_PHASE_RUNNING, BARRIER_PHASE_STALLED)
        due = world_may_run and _is_complete(awaited) and now_s >= self.pace.due_s
        inputs = self._fire(awaited, now_s) if due else None
        silent = tuple(
            arm
            for arm, seat in self._driven.items()
            if seat.operator in _GIVEN_UP and now_s - seat.heard_s >= FREED_AFTER_S
        )
        will_fire = world_may_run and _is_complete(awaited)
        return Decision(phase, waiting_for, silent, inputs, self._next_s(now_s, will_fire))

    def _objection(self, received: ReceivedCommand) -> CommandRejection | None:
        seat = self._seats.get(received.arm)
        if seat is None:
            return CommandRejection.UNKNOWN_ARM
        if not seat.driven:
            return CommandRejection.FREE_SEAT
        if received.seat_epoch != seat.epoch:
            return CommandRejection.WRONG_EPOCH
        if received.sequence <= seat.last_sequence:
            return CommandRejection.OLD_SEQUENCE
        if seat.last_sequence >= 0 and received.sequence - seat.last_sequence > MAX_SEQUENCE_LEAP:
            return CommandRejection.LEAP
        return None

    def _presses_stop(self, received: ReceivedCommand) -> bool:
        before = self._seats[received.arm].newest
        return received.emergency_stop and not (before is not None and before.emergency_stop)

    def _phase(
        self, awaited: Mapping[str, _SeatState], now_s: float
    ) -> tuple[BarrierPhase, tuple[tuple[str, float], ...]]:
        if self._stop is not None:
            arm, since_s = self._stop
            return BARRIER_PHASE_STOPPED, ((arm, now_s - since_s),) if arm else ()
        missing = tuple(
            (arm, now_s - seat.heard_s)
            for arm, seat in awaited.items()
            if now_s - seat.heard_s >= STALLED_AFTER_S
        )
        if not missing:
            return BARRIER_PHASE_RUNNING, ()
        longest_s = max(since_s for _, since_s in missing)
        return BARRIER_PHASE_PAUSED if longest_s >= PAUSED_AFTER_S else BARRIER_PHASE_STALLED, missing

    def _fire(self, driven: Mapping[str, _SeatState], now_s: float) -> TickInputs:
        commands = {}
        resumed = self._stood or not all(seat.begun for seat in driven.values())
        for arm, seat in driven.items():
            assert seat.newest is not None  # it is unused, so it is there
            commands[arm] = seat.newest
            seat.unused, seat.begun = False, True
        straggler = max(driven, key=lambda arm: driven[arm].complete_s, default=None)
        due_s = self.pace.due_s
        late_s = max(0.0, driven[straggler].complete_s - due_s) if straggler is not None else 0.0
        if resumed:
            self.pace.restart(now_s)  # nobody catches up with what was no slowness
        self.pace.fired(now_s)
        self._stood = False
        return TickInputs(commands, due_s, straggler, late_s, resumed)

    def _next_s(self, now_s: float, will_fire: bool) -> float:
        """Return when the answer may change without a new command; `now_s` where it has changed already."""
        moments = [
            moment
            for seat in self._driven.values()
            for after_s in (STALLED_AFTER_S, PAUSED_AFTER_S, FREED_AFTER_S)
            if (moment := seat.heard_s + after_s) > now_s
        ]
        if will_fire:
            moments.append(max(self.pace.due_s, now_s))
        return min(moments, default=float("inf"))


def _is_complete(awaited: Mapping[str, _SeatState]) -> bool:
    """Whether everyone who is waited for has given a new command."""
    return all(seat.unused for seat in awaited.values())
