"""The newest status of every room that was heard of. Pure; times are monotonic seconds."""

from __future__ import annotations

from dataclasses import dataclass, replace

from mart.protocol.errors import NotFound
from mart.protocol.holders import is_held_by
from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STOPPED,
    RoomStatus,
    Seat,
)

SILENT_AFTER_S = 0.35  # a sim speaks ten times a second
OVERTAKEN_WITHIN_S = 1.0  # by the answer to a request
SLOW = 0.95  # of real time: below it, people feel it
SLOW_AFTER_S = 2.0  # a hiccup is no alarm
GONE_AFTER_S = 3.0  # without its liveliness token; a router's restart takes every token for about 2 s


@dataclass(frozen=True)
class _Room:
    status: RoomStatus
    seen_s: float
    alive: bool
    slow_since_s: float | None  # of every status since


class RoomTable:
    """Every room that was heard of. A silent room is stale; a silent one whose sim is gone disappears."""

    def __init__(self) -> None:
        self._rooms: dict[str, _Room] = {}
        self._alive: set[str] = set()
        self._stale: set[str] = set()  # as last asked

    def see(self, status: RoomStatus, now_s: float) -> bool:
        """Keep `status` as its room's newest; return whether it is.

        Answers overtake what was said before them. A status that says it is older than a fresh one of the same sim
        is not used, or whoever has just taken a seat would be shown without it. Neither is one of a room whose sim has
        no liveliness token, unless it had one just now.
        """
        if status.room not in self._alive and status.room not in self._rooms:
            return False
        known = self._rooms.get(status.room)
        if (
            known is not None
            and now_s - known.seen_s <= OVERTAKEN_WITHIN_S
            and _is_older(status, known.status)
        ):
            return False
        before_s = known.slow_since_s if known is not None else None
        slow_since_s = _slow_since_s(status, before_s, now_s)
        self._rooms[status.room] = _Room(status, now_s, status.room in self._alive, slow_since_s)
        return True

    def set_alive(self, room: str, alive: bool) -> None:
        """Take in whether the sim of `room` runs."""
        (self._alive.add if alive else self._alive.discard)(room)
        if room in self._rooms:
            self._rooms[room] = replace(self._rooms[room], alive=alive)

    @property
    def unheard(self) -> set[str]:
        """Rooms whose sim runs and that have not said anything yet."""
        return self._alive - self._rooms.keys()

    def names(self, now_s: float) -> list[str]:
        """Return the names of the rooms that are there, sorted."""
        self._forget(now_s)
        return sorted(self._rooms)

    def status(self, room: str, now_s: float) -> RoomStatus:
        """Return the newest status of `room`; raises NotFound, with the rooms that are open, where there is none."""
        self._forget(now_s)
        if room not in self._rooms:
            raise NotFound.named("room", room, self._rooms)
        return self._rooms[room].status

    def seat(self, room: str, arm: str, now_s: float) -> Seat:
        """Return the seat of `arm` in `room`; raises NotFound where the room or the arm does not exist."""
        status = self.status(room, now_s)
        for seat in status.seats:
            if seat.arm == arm:
                return seat
        raise NotFound.named("arm", arm, (seat.arm for seat in status.seats))

    def seats_of(self, holder_id: str, now_s: float) -> list[tuple[str, str]]:
        """Return the room and the arm of each seat that the user with `holder_id` holds."""
        self._forget(now_s)
        return [
            (name, seat.arm)
            for name, room in sorted(self._rooms.items())
            for seat in room.status.seats
            if is_held_by(seat, holder_id)
        ]

    def seats(self, room: str) -> tuple[Seat, ...]:
        """Return the seats of `room`, none where it is not known."""
        known = self._rooms.get(room)
        return () if known is None else tuple(known.status.seats)

    def is_stale(self, room: str, now_s: float) -> bool:
        """Whether `room` is silent, or its sim is gone."""
        known = self._rooms[room]
        return not known.alive or now_s - known.seen_s > SILENT_AFTER_S

    def is_slow(self, room: str, now_s: float) -> bool:
        """Whether the world of `room` runs, and has run slower than real time for a while."""
        known = self._rooms[room]
        runs = known.status.barrier == BARRIER_PHASE_RUNNING
        return runs and known.slow_since_s is not None and now_s - known.slow_since_s >= SLOW_AFTER_S

    def have_fallen_silent(self, now_s: float) -> bool:
        """Return whether any room has become stale since this was last asked."""
        before = self._stale
        self._stale = {room for room in self._rooms if self.is_stale(room, now_s)}
        return bool(self._stale - before)

    def _forget(self, now_s: float) -> None:
        self._rooms = {
            name: room
            for name, room in self._rooms.items()
            if room.alive or now_s - room.seen_s <= GONE_AFTER_S
        }


def _is_older(status: RoomStatus, known: RoomStatus) -> bool:
    return status.boot == known.boot and status.wall_ns < known.wall_ns


def _slow_since_s(status: RoomStatus, before_s: float | None, now_s: float) -> float | None:
    """Return since when a room is slow, None where it is not; `before_s`: what held with the status before.

    A world that is paused or stopped, or has not begun, is not slow; one that waits for somebody is neither.
    """
    stands = status.barrier in (BARRIER_PHASE_PAUSED, BARRIER_PHASE_STOPPED) or not status.tick
    if stands or status.real_time_factor >= SLOW:
        return None
    return now_s if before_s is None else before_s
