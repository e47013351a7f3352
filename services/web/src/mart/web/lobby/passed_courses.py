"""Notice who passes the practice course, from what its rooms say. Pure, but for `keep`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from mart.protocol.holders import is_held_by
from mart.protocol.messages import RoomStatus
from mart.protocol.practice import has_passed, stations_of

# Keeps that somebody has passed: whether a holder id is theirs, in how many seconds, in how many tries.
KeepPass = Callable[[Callable[[str], bool], float, int], object]


class PassedCourses:
    """Tell `keep` once of every time that somebody is through all stations."""

    def __init__(self, keep: KeepPass) -> None:
        self._keep = keep
        self._told: set[tuple[str, str]] = set()  # room and arm of who is through now

    def see_status(self, status: RoomStatus) -> None:
        """Take in a room's status. Raises what `keep` raises; it is then told again with the next status."""
        for seat in status.seats:
            place = (status.room, seat.arm)
            if not has_passed(status, seat.arm):
                self._told.discard(place)
            elif place not in self._told:
                stations = stations_of(status, seat.arm)
                seconds, tries = sum(one.seconds for one in stations), sum(one.tries for one in stations)
                self._keep(partial(is_held_by, seat), seconds, tries)
                self._told.add(place)
