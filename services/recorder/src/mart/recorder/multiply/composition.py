"""Choose what an episode is made of: for each arm, whose way it goes, and where several keep one time. Pure.

Arms that work alone may each follow another demonstration; those that work together follow one. It is drawn among the
demonstrations whose things lay most alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mart.protocol.tasks import Task
from mart.recorder.multiply.carried_segment import Placed
from mart.recorder.multiply.demonstration import Demonstration, things_of
from mart.recorder.multiply.segments import (
    Segment,
    acting,
    first_done,
    segments_of,
    together,
    together_from,
)
from mart.recorder.multiply.transport import yaw_of

_AMONG = 3  # demonstrations that lie most alike
_M_PER_RAD = 0.1


@dataclass(frozen=True)
class WayPiece:
    """Go an arm's way in one demonstration, from the first segment to the last.

    meets: the tick at which it waits for all it works with, and from which they keep time; None: it works alone.
    awaits: subtasks of others that are done here before this tick: the way does not go on beyond it until they are.
    """

    demonstration: Demonstration
    segments: tuple[Segment, ...]
    meets: int | None
    awaits: tuple[tuple[int, str], ...]


@dataclass(frozen=True)
class ArmLibrary:
    """Hold what one arm did in one demonstration: alone, then with others."""

    alone: tuple[Segment, ...]
    joined: tuple[Segment, ...]


class Composer:
    """Draw what episodes of a task are made of, from these demonstrations."""

    def __init__(self, task: Task, demonstrations: Sequence[Demonstration]) -> None:
        self._task, self._demonstrations = task, demonstrations
        self._group = together(task)
        self._precedes = _always_before(task, demonstrations)
        self._libraries = [
            {arm: _library(task, one, arm) for arm in task.arm_names} for one in demonstrations
        ]

    def segments(self) -> list[tuple[Demonstration, Segment]]:
        """Return every segment with the demonstration that it is of."""
        return [
            (one, segment)
            for one, library in zip(self._demonstrations, self._libraries, strict=True)
            for own in library.values()
            for segment in (*own.alone, *own.joined)
        ]

    def compose(
        self, placed: Mapping[str, Placed], random: np.random.Generator
    ) -> dict[str, tuple[WayPiece, ...]]:
        """Return each arm's pieces, for a world in which things lie so."""
        shared = self._draw(things_of(self._task), placed, random) if self._group else None
        composed = {}
        for arm in self._task.arm_names:
            own = shared if arm in self._group else None
            alone = self._draw(self._seen_by(arm), placed, random)
            if own is not None and not self._follow_on(arm, alone, own):
                alone = own
            composed[arm] = self._pieces(arm, alone, own)
        return composed

    def _pieces(self, arm: str, alone: int, joined: int | None) -> tuple[WayPiece, ...]:
        pieces = []
        first = self._libraries[alone][arm].alone
        if first:
            pieces.append(WayPiece(self._demonstrations[alone], first, None, self._awaited(arm, alone)))
        if joined is not None and self._libraries[joined][arm].joined:
            one = self._demonstrations[joined]
            meets = max(together_from(self._task, one, each) for each in self._group)
            pieces.append(WayPiece(one, self._libraries[joined][arm].joined, meets, ()))
        return tuple(pieces)

    def _follow_on(self, arm: str, alone: int, joined: int) -> bool:
        """Tell whether an arm's own part of one demonstration ends as the other's common part begins."""
        first, then = self._libraries[alone][arm].alone, self._libraries[joined][arm].joined
        return not first or not then or first[-1].kind.closed == then[0].kind.closed

    def _awaited(self, arm: str, index: int) -> tuple[tuple[int, str], ...]:
        one = self._demonstrations[index]
        return tuple((first_done(one, name), name) for name in self._precedes[arm])

    def _seen_by(self, arm: str) -> tuple[str, ...]:
        seen = {one.name for one in self._task.observations_of(arm)}
        return tuple(thing for thing in things_of(self._task) if f"{thing}/position_in_world" in seen)

    def _draw(self, things: Sequence[str], placed: Mapping[str, Placed], random: np.random.Generator) -> int:
        """Draw among the demonstrations whose things began most like these."""
        apart = [sum(_apart(one, thing, placed[thing]) for thing in things) for one in self._demonstrations]
        return int(random.choice(np.argsort(apart, kind="stable")[:_AMONG]))


def _library(task: Task, demonstration: Demonstration, arm: str) -> ArmLibrary:
    begin = together_from(task, demonstration, arm)
    segments = segments_of(task, demonstration, arm)
    return ArmLibrary(
        alone=tuple(one for one in segments if one.begin < begin),
        joined=tuple(one for one in segments if one.begin >= begin),
    )


def _always_before(task: Task, demonstrations: Sequence[Demonstration]) -> dict[str, tuple[str, ...]]:
    """Return for each arm the subtasks of others that it waits for while it works alone.

    These were done after the same of its own, and before the next one, in every demonstration: as they always come in
    this order, arms that follow different demonstrations never wait for each other.
    """
    before = {}
    for arm in task.arm_names:
        own = [one.name for one in task.subtasks if arm in acting(one) and not one.coordinated]
        others = [one.name for one in task.subtasks if arm not in acting(one)]
        before[arm] = tuple(other for other in others if _comes_between(other, own, demonstrations))
    return before


def _comes_between(other: str, own: Sequence[str], demonstrations: Sequence[Demonstration]) -> bool:
    """Tell whether a subtask is always done before the last of these, and after the same of them."""
    places = set()
    for one in demonstrations:
        tick = first_done(one, other)
        places.add(sum(first_done(one, name) <= tick for name in own))
    return len(places) == 1 and places.pop() < len(own)


def _apart(demonstration: Demonstration, thing: str, now: Placed) -> float:
    track = demonstration.things[thing]
    apart = float(np.linalg.norm(track.positions[0] - now.position))
    if track.quaternions is None or now.yaw_rad is None:
        return apart
    turn = np.angle(np.exp(1j * (yaw_of(track.quaternions[0]) - now.yaw_rad)))
    return apart + _M_PER_RAD * abs(float(turn))
