"""Lead all arms of one world along what was composed for it, tick by tick. Pure: what is seen comes in, targets go out.

Each arm has a clock that counts the demonstration's ticks. It runs as fast as ours, slower where the carried way is
longer than the demonstrated one, so that no arm is led faster than it was shown; it stands where the arm waits for
others. From where arms meet, their clocks are one.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from mart.protocol.tasks import Task
from mart.recorder.multiply.carried_segment import CarriedSegment, Placed
from mart.recorder.multiply.composition import WayPiece
from mart.recorder.multiply.demonstration import ToolInWorld
from mart.recorder.multiply.references import Reference
from mart.recorder.multiply.segments import CLOSES, OPENS, Segment, SegmentKind

_FASTER = 1.3  # than shown, at the same place
_BRISK_SHARE = 0.9  # of the demonstrated steps are slower than what is always allowed
_LEAST_STEP_M = 0.004
_SLOWEST = 0.05  # ticks of the demonstration in one of ours
_ROUNDING_M = 1e-9


class _ArmPlayer:
    """Play the pieces of one arm. last: the target before the first tick."""

    def __init__(
        self,
        pieces: tuple[WayPiece, ...],
        references: Mapping[SegmentKind, Reference],
        last: ToolInWorld,
        most_m: float,
    ) -> None:
        self._references, self._most_m = references, most_m
        self._parts = [(piece, segment) for piece in pieces for segment in piece.segments]
        self._next = 0
        self.last = last
        self.tick = -1.0  # of the demonstration, that was gone last
        self._carried: CarriedSegment | None = None
        self._piece: WayPiece | None = None
        self._before: Segment | None = None
        self._brisk_m = _LEAST_STEP_M
        self._begin_next()

    @property
    def done(self) -> bool:
        """Whether the way is at its end; the arm stays there."""
        return self._carried is None

    @property
    def meets(self) -> int | None:
        return self._piece.meets if self._piece is not None else None

    @property
    def is_at_meeting(self) -> bool:
        """Whether all that this arm goes through before it meets others is done."""
        return self.meets is not None and self.tick >= self.meets - 1

    def may_go(self, done: Collection[str]) -> bool:
        """Tell whether what this arm awaits at its tick has been done."""
        assert self._piece is not None
        return all(self.tick < tick or name in done for tick, name in self._piece.awaits)

    def proposed(self, placed: Mapping[str, Placed]) -> float:
        """Return by how many ticks of the demonstration, at most 1, the arm can go on now."""
        assert self._carried is not None
        following = min(self.tick + 1.0, self._carried.segment.end - 1.0)
        shown_m = self._carried.demonstrated_m(self.tick, following)
        allowed_m = max(min(max(_FASTER * shown_m, self._brisk_m), self._most_m), shown_m)
        ahead_m = float(np.linalg.norm(self._carried.target(following, placed).position - self.last.position))
        share = 1.0 if ahead_m <= allowed_m + _ROUNDING_M else max(allowed_m / ahead_m, _SLOWEST)
        return share * (following - self.tick)

    def go(self, ticks: float, placed: Mapping[str, Placed]) -> ToolInWorld:
        """Go on by so many ticks of the demonstration, and return the target."""
        assert self._carried is not None
        later = self.tick + ticks
        if self.meets is not None and not self.is_at_meeting:
            later = min(later, self.meets - 1.0)
        self.tick, self.last = later, self._carried.target(later, placed)
        if self.tick >= self._carried.segment.end - 1.0:
            self._begin_next()
        return self.last

    def _begin_next(self) -> None:
        if self._next >= len(self._parts):
            self._carried = self._piece = None
            return
        piece, segment = self._parts[self._next]
        self._next += 1
        if piece is not self._piece:
            self._piece, self.tick = piece, segment.begin - 1.0
            self._brisk_m = _brisk_step_m(piece, segment.arm)
        in_contact = self._before is not None and self._before.kind.end in (CLOSES, OPENS)
        self._before = segment
        origin = piece.demonstration.ways[segment.arm].at(self.tick)
        reference = self._references[segment.kind]
        self._carried = CarriedSegment(
            piece.demonstration, segment, reference, self.last, origin, in_contact=in_contact
        )


class WayPlayer:
    """Lead the arms of one world. lasts: by arm, where its tool is at first."""

    def __init__(
        self,
        task: Task,
        pieces: Mapping[str, tuple[WayPiece, ...]],
        references: Mapping[SegmentKind, Reference],
        lasts: Mapping[str, ToolInWorld],
    ) -> None:
        self.pieces = pieces
        self._arms = {
            arm.name: _ArmPlayer(pieces[arm.name], references, lasts[arm.name], arm.kind.limits.step_m)
            for arm in task.arms
        }
        self._done: set[str] = set()

    @property
    def done(self) -> bool:
        """Whether every arm's way is at its end."""
        return all(arm.done for arm in self._arms.values())

    def targets(self, placed: Mapping[str, Placed], done: Collection[str]) -> dict[str, ToolInWorld]:
        """Return where each tool is to be next. done: the subtasks that are done now."""
        self._done.update(done)
        going = {name: arm for name, arm in self._arms.items() if not arm.done and arm.may_go(self._done)}
        joined = self._joined()
        if joined and not joined <= going.keys():
            joined = set()
        ticks = {name: arm.proposed(placed) for name, arm in going.items()}
        if joined:
            common = min(ticks[name] for name in joined)
            ticks |= dict.fromkeys(joined, common)
        waiting = {name for name, arm in going.items() if arm.is_at_meeting and name not in joined}
        return {
            name: arm.go(ticks[name], placed) if name in going and name not in waiting else arm.last
            for name, arm in self._arms.items()
        }

    def _joined(self) -> set[str]:
        """Return the arms that keep one time now: all that meet have come to where they do."""
        together = {
            name: arm
            for name, arm in self._arms.items()
            if any(p.meets is not None for p in self.pieces[name])
        }
        there = {name for name, arm in together.items() if arm.done or arm.is_at_meeting}
        if there != together.keys():
            return set()
        return {name for name in there if not together[name].done}


def _brisk_step_m(piece: WayPiece, arm: str) -> float:
    """Return a step that is always allowed: as large as the larger ones that were shown, metres a tick."""
    steps = np.linalg.norm(np.diff(piece.demonstration.ways[arm].positions, axis=0), axis=1)
    return max(float(np.quantile(steps, _BRISK_SHARE)) if len(steps) else 0.0, _LEAST_STEP_M)
