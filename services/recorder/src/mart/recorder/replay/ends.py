"""Tell from a room's statuses when a replay is over: whatever stops a room, or takes it further, ends it. Pure."""

from __future__ import annotations

from collections.abc import Collection

from mart.protocol.holders import is_held_by
from mart.protocol.messages import EPISODE_PHASE_PRACTICE, RoomStatus


def objection_to_room(status: RoomStatus, arms: Collection[str]) -> str:
    """Return why arms of a room may not be led along a way now, a sentence; empty where they may."""
    if status.HasField("stop"):
        why = f": {status.stop.fault}" if status.stop.fault else "."
        return f"{status.stop.name} stopped everything{why}"
    if status.episode.phase != EPISODE_PHASE_PRACTICE:
        return f"An episode is under way in {status.room}; a replay is for the time between episodes."
    for driven in status.driven_arms:
        if driven.arm in arms and (driven.fault or not driven.driver):
            return f"The driver of {driven.arm} is not ready: {driven.fault or 'none has connected.'}"
    return ""


class EndWatch:
    """Latch why a replay ended, from every status that came since its seats were taken."""

    def __init__(self, arms: Collection[str], holder_id: str) -> None:
        self.why = ""
        self._arms, self._holder_id = arms, holder_id
        self._boot: int | None = None
        self._seated = False

    def hear(self, status: RoomStatus) -> None:
        """Take a status; the first reason is kept."""
        self.why = self.why or objection_to_room(status, self._arms) or self._seats(status)

    def _seats(self, status: RoomStatus) -> str:
        if self._boot not in (None, status.boot):
            return f"{status.room} was started anew."
        self._boot = status.boot
        seats = [seat for seat in status.seats if seat.arm in self._arms]
        lost = [seat for seat in seats if not is_held_by(seat, self._holder_id)]
        self._seated = self._seated or not lost
        if self._seated and lost:
            return f"The seat of {lost[0].arm} is {lost[0].name or 'nobody'}'s now."
        return ""
