"""Decide how an episode goes on. Pure: requests, ticks and `now` in, effects out, which the room carries out.

    practice ── everyone ready ──► countdown ── 3 s, all present ──► recording ── outcome ──► ended ── 2 s ──► practice

The world is reset on the way into countdown and on the way back into practice. While anything but practice and
recording lasts, the world stands still. Readiness is an agreement about who drives what: any change of a seat voids it,
and calls off a countdown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.messages import (
    ENDED_BY_ABSENCE,
    ENDED_BY_ROOM,
    ENDED_BY_TASK,
    ENDED_BY_TIME,
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OUTCOME_DISCARDED,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    OUTCOME_UNSPECIFIED,
    EpisodePhase,
    EpisodeRequest,
    Outcome,
    phase_word,
)
from mart.protocol.received import MAX_NUMBER
from mart.sim.room.episode_say import EpisodeEnder, called, ender_of, require_say
from mart.sim.room.seats import SeatTable

COUNTDOWN_S = 3.0
ENDED_S = 2.0
MAX_NUMBER_LEAP = 1_000_000  # of one request: whoever could leap further would leave the room no numbers


@dataclass(frozen=True)
class Terms:
    """Hold what is true of every episode of a room; time_limit_s: None: as long as the task allows.

    practice: there are none, because nothing is recorded in this room.
    """

    lockstep: bool = False
    skill: str = ""
    time_limit_s: float | None = None
    practice: bool = False
    cameras: tuple[str, ...] = ()  # the ids of real ones


@dataclass(frozen=True)
class ResetWorld:
    """Ask for the world to be reset with `seed`."""

    seed: int


@dataclass(frozen=True)
class BeginEpisode:
    """Ask for the recording to begin: the next state is the episode's first."""

    number: int
    seed: int


@dataclass(frozen=True)
class EndEpisode:
    """Ask for the recording to end with this outcome."""

    number: int
    outcome: Outcome
    ticks: int
    reason: str
    ender: EpisodeEnder


Effect = ResetWorld | BeginEpisode | EndEpisode


def seed_of(room_seed: int, stream: str, number: int) -> int:
    """Return the seed, below 2³², of a room's reset number `number`; `stream` keeps episodes apart from practice."""
    entropy = (room_seed, *stream.encode(), number)
    return int(np.random.SeedSequence(entropy).generate_state(1, np.uint32)[0])


class EpisodeStateMachine:
    """Hold where a room stands between practice and outcome; `number` is the newest episode's, 0 before any."""

    def __init__(self, room_seed: int, horizon_ticks: int, number: int = 0) -> None:
        self.number = number
        self.phase: EpisodePhase = EPISODE_PHASE_PRACTICE
        self.seed = seed_of(room_seed, "practice", number)
        self.ticks = 0
        self.outcome: Outcome = OUTCOME_UNSPECIFIED
        self.reason = ""
        self.ender = EpisodeEnder()
        self.interrupted = False
        self._room_seed = room_seed
        self._horizon_ticks = horizon_ticks
        self._practices = 0
        self._until_s = 0.0
        self._ready: frozenset[str] = frozenset()

    @property
    def recording(self) -> bool:
        """Whether an episode is being recorded."""
        return self.phase == EPISODE_PHASE_RECORDING

    @property
    def world_runs(self) -> bool:
        """Whether the world may tick: in practice and while recording."""
        return self.phase in (EPISODE_PHASE_PRACTICE, EPISODE_PHASE_RECORDING)

    def is_ready(self, arm: str) -> bool:
        """Whether the arm's operator has said to be ready."""
        return arm in self._ready

    def remaining_s(self, now_s: float) -> float:
        """Return the seconds left of the countdown, 0 outside one."""
        return max(0.0, self._until_s - now_s) if self.phase == EPISODE_PHASE_COUNTDOWN else 0.0

    def next_s(self, now_s: float) -> float:
        """Return when `advance` may have something to do (monotonic seconds), infinity where it has not."""
        waits = self.phase in (EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_ENDED) and self._until_s > now_s
        return self._until_s if waits else float("inf")

    def answer(self, request: EpisodeRequest, seats: SeatTable, now_s: float) -> Sequence[Effect]:
        """Do what a request asks; raises Conflict, Forbidden, InvalidInput or NotFound."""
        match request.WhichOneof("what"):
            case "ready":
                return self._answer_ready(request.ready, seats, now_s)
            case "finish":
                return self._answer_finish(request.finish, seats, now_s)
            case "reset":
                return self._answer_reset(request.reset, seats, now_s)
        raise InvalidInput("An empty episode request was given; ask for ready, finish or reset.")

    def seats_changed(self, seats: SeatTable, now_s: float) -> Sequence[Effect]:
        """Void all readiness, because somebody came, left or was replaced."""
        self._ready = frozenset()
        if self.phase == EPISODE_PHASE_COUNTDOWN:
            return self.abandon(OUTCOME_DISCARDED, "the seats changed", EpisodeEnder(ENDED_BY_ABSENCE), now_s)
        if self.recording and all(seat.operator == OPERATOR_HOLD for seat in seats):
            return self.end(OUTCOME_DISCARDED, "everyone left", EpisodeEnder(ENDED_BY_ABSENCE), now_s)
        return ()

    def advance(self, everyone_present: bool, now_s: float) -> Sequence[Effect]:
        """Go on where time has passed. A countdown waits at 0 until everyone is present."""
        if now_s < self._until_s:
            return ()
        if self.phase == EPISODE_PHASE_COUNTDOWN and everyone_present:
            self.phase = EPISODE_PHASE_RECORDING
            return (BeginEpisode(self.number, self.seed),)
        if self.phase == EPISODE_PHASE_ENDED:
            return self.practise_anew()
        return ()

    def ticked(self, success: bool, failed: str | None, now_s: float) -> Sequence[Effect]:
        """Count a tick; `success` and `failed` are what the task says of this instant."""
        if not self.recording:
            return ()
        self.ticks += 1
        if success:
            return self.end(OUTCOME_SUCCESS, "the task is done", EpisodeEnder(ENDED_BY_TASK), now_s)
        if failed:
            return self.end(OUTCOME_FAILURE, failed, EpisodeEnder(ENDED_BY_TASK), now_s)
        if self.ticks >= self._horizon_ticks:
            return self.end(OUTCOME_FAILURE, "time is up", EpisodeEnder(ENDED_BY_TIME), now_s)
        return ()

    def interrupt(self) -> None:
        """Mark a recording as interrupted, because the room was paused or stopped."""
        self.interrupted = self.interrupted or self.recording

    def end(self, outcome: Outcome, reason: str, ender: EpisodeEnder, now_s: float) -> Sequence[Effect]:
        """End the recording with this outcome."""
        self.phase = EPISODE_PHASE_ENDED
        self.outcome, self.reason, self.ender = outcome, reason, ender
        self._until_s = now_s + ENDED_S
        return (EndEpisode(self.number, outcome, self.ticks, reason, ender),)

    def abandon(self, outcome: Outcome, reason: str, ender: EpisodeEnder, now_s: float) -> Sequence[Effect]:
        """Go back to practice with a fresh world at once; a recording ends with this outcome."""
        if self.recording:
            return (*self.end(outcome, reason, ender, now_s), *self.practise_anew())
        if self.phase == EPISODE_PHASE_COUNTDOWN:
            self.number -= 1  # this episode never began; its number is free again
        return self.practise_anew()

    def practise_anew(self) -> Sequence[Effect]:
        """Go on practising in a fresh world; call it where nothing is under way."""
        self._practices += 1
        self._begin(
            EPISODE_PHASE_PRACTICE, seed_of(self._room_seed, f"practice {self._practices}", self.number)
        )
        return (ResetWorld(self.seed),)

    def diverged(self, now_s: float) -> Sequence[Effect]:
        """Begin anew where the physics left their bounds."""
        return self.abandon(OUTCOME_FAILURE, "the physics diverged", EpisodeEnder(ENDED_BY_ROOM), now_s)

    def _answer_ready(self, ready: EpisodeRequest.Ready, seats: SeatTable, now_s: float) -> Sequence[Effect]:
        seat = seats[ready.arm]
        require_say(seats, (seat,), ready.holder_id)
        if self.phase == EPISODE_PHASE_COUNTDOWN and not ready.ready:
            return self.seats_changed(seats, now_s)
        if self.phase != EPISODE_PHASE_PRACTICE:
            raise Conflict(
                f"Readiness was given during {phase_word(self.phase)}; it counts in practice only."
            )
        if all(seat.operator == OPERATOR_HOLD for seat in seats):
            raise Conflict("An episode was asked for, but nobody drives; take a seat or set one to script.")
        self._require_number(ready.number)
        self._ready = self._ready | {seat.arm} if ready.ready else self._ready - {seat.arm}
        humans = {human.arm for human in seats.of_operator(OPERATOR_HUMAN)}
        return self._count_down(ready.number, now_s) if self._ready and humans <= self._ready else ()

    def _require_number(self, wanted: int) -> None:
        most = min(self.number + MAX_NUMBER_LEAP, MAX_NUMBER)
        if wanted and wanted <= self.number:
            raise Conflict(
                f"Episode {wanted} was asked for, but {self.number} was here already; give a later one or none."
            )
        if max(wanted, self.number + 1) > most:
            raise InvalidInput(
                f"Episode {wanted or self.number + 1} was asked for, but this room is at {self.number}: "
                f"give a number up to {most}, or open another room."
            )

    def _answer_finish(
        self, finish: EpisodeRequest.Finish, seats: SeatTable, now_s: float
    ) -> Sequence[Effect]:
        ender = ender_of(seats, finish)
        if not self.recording:
            raise Conflict(f"An outcome was given during {phase_word(self.phase)}; only a recording has one.")
        if finish.outcome not in (OUTCOME_SUCCESS, OUTCOME_FAILURE, OUTCOME_DISCARDED):
            raise InvalidInput(
                "An outcome that does not exist was given; it must be success, failure or discarded."
            )
        return self.end(finish.outcome, f"said by {called(ender)}", ender, now_s)

    def _answer_reset(self, reset: EpisodeRequest.Reset, seats: SeatTable, now_s: float) -> Sequence[Effect]:
        ender = ender_of(seats, reset)
        return self.abandon(OUTCOME_DISCARDED, f"reset by {called(ender)}", ender, now_s)

    def _count_down(self, number: int, now_s: float) -> Sequence[Effect]:
        self.number = number or self.number + 1
        self._begin(EPISODE_PHASE_COUNTDOWN, seed_of(self._room_seed, "episode", self.number))
        self._until_s = now_s + COUNTDOWN_S
        return (ResetWorld(self.seed),)

    def _begin(self, phase: EpisodePhase, seed: int) -> None:
        self.phase, self.seed, self.ticks = phase, seed, 0
        self.outcome, self.reason, self.interrupted = OUTCOME_UNSPECIFIED, "", False
        self.ender = EpisodeEnder()
        self._ready = frozenset()
        self._until_s = 0.0
