"""Decide who may record in a room: nobody in one for practice, else everybody or who has passed the course. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from mart.protocol.errors import Conflict, Forbidden
from mart.protocol.messages import OPERATOR_HUMAN, EpisodeRequest, SeatRequest
from mart.sim.room.seats import SeatTable


@dataclass(frozen=True)
class RecordingRules:
    """Hold what a room allows. practice: nothing is recorded. course_required: who has not passed practises only."""

    practice: bool = False
    course_required: bool = False

    def require_may_begin(self, request: EpisodeRequest, seats: SeatTable) -> None:
        """Raise Conflict or Forbidden where somebody says to be ready for what they may not do; NotFound for no arm."""
        if not request.HasField("ready") or not request.ready.ready:
            return
        if self.practice:
            raise Conflict("This is a practice room: nothing is recorded here. Record in another room.")
        seat = seats[request.ready.arm]
        if self.course_required and seat.operator == OPERATOR_HUMAN and not seat.passed_course:
            raise Forbidden(
                f"{seat.name} has not passed the practice course, which this room asks for before anybody records. "
                "Practise here, or pass the course in a practice room first."
            )

    def require_may_come(self, request: SeatRequest, seats: SeatTable, *, practising: bool) -> None:
        """Raise Conflict where somebody takes a seat in mid-episode who may not record; NotFound for no arm."""
        claim = request.claim
        if practising or not self.course_required or not request.HasField("claim"):
            return
        returns = seats[claim.arm].holder_id == claim.holder_id
        if claim.operator == OPERATOR_HUMAN and not claim.passed_course and not returns:
            raise Conflict(
                f"{claim.name} has not passed the practice course, which this room asks for, and an episode is being "
                "recorded. Take the seat when it is over, or pass the course in a practice room first."
            )
