"""Find out what each kind of segment is about: the thing in whose frame the demonstrations agree most. Pure.

Ends of segments are laid over one another in the frame of every thing, in the world, and from where the tool began.
Where they lie closest is what the segment acts on: fingers close at the cube, not at a place of the table; a tray is
set down at a place of the table, wherever it was before. Where no fingers close, the middles of their last halves count
as well: a way that rubs ends anywhere. How often a thing looks the same while it turns is told by the turns at which it
was gripped.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mart.protocol.pose import Array
from mart.recorder.multiply.demonstration import Demonstration
from mart.recorder.multiply.segments import CLOSES, Segment, SegmentKind
from mart.recorder.multiply.transport import turned, yaw_of

WORLD, TOOL = "the world", "the tool"  # no thing's name has a blank
_ANY_TURN = 0
_FEWEST = 3  # segments of a kind that tell more than the nearest thing does
_AS_GOOD, _TIE = 1.5, 1.1  # times the closest, where a thing with a turn, or the tool, is taken instead
_ALIKE_M = 0.001
_HELD_M, _MOVED_M = 0.02, 0.02
_SPREADS_RAD = {1: 0.35, 2: 0.2, 4: 0.15}  # by how often a thing looks the same in a turn


@dataclass(frozen=True)
class Reference:
    """Say in whose frame a segment is carried.

    frame: a thing's name, WORLD, or TOOL: as the way before it was carried. order: how often the thing looks the same
    in a turn about the vertical; 0: its turn means nothing.
    """

    frame: str
    order: int = 1


@dataclass(frozen=True)
class _Ending:
    """Hold how one segment ended: tool at its begin and end, and things, then."""

    demonstration: Demonstration
    segment: Segment

    @property
    def begin_m(self) -> Array:
        return np.asarray(self.demonstration.ways[self.segment.arm].positions[self.segment.begin])

    @property
    def places_m(self) -> Array:
        """Where it ended; unless fingers closed there, the middle of its last half, too; shape (1 or 2, 3)."""
        way = self.demonstration.ways[self.segment.arm].positions[self.segment.begin : self.segment.end]
        if self.segment.kind.end == CLOSES:
            return np.asarray(way[-1:])
        return np.stack([way[-1], way[len(way) // 2 :].mean(axis=0)])

    @property
    def tool_yaw(self) -> float:
        return yaw_of(self.demonstration.ways[self.segment.arm].quaternions[self.segment.end - 1])

    def thing_m(self, thing: str) -> Array:
        return np.asarray(self.demonstration.things[thing].positions[self.segment.end - 1])

    def thing_yaw(self, thing: str) -> float | None:
        quaternions = self.demonstration.things[thing].quaternions
        return None if quaternions is None else yaw_of(quaternions[self.segment.end - 1])

    def goes_with(self, thing: str) -> bool:
        """Tell whether a thing went along with the tool."""
        begin, end = self.segment.begin, self.segment.end - 1
        positions = self.demonstration.things[thing].positions
        way = self.demonstration.ways[self.segment.arm].positions
        moved = positions[end] - positions[begin]
        led = way[end] - way[begin]
        return bool(
            np.linalg.norm(moved) > _MOVED_M
            and np.linalg.norm(moved - led) < max(_HELD_M, 0.5 * float(np.linalg.norm(led)))
        )


def references_of(
    segments: Iterable[tuple[Demonstration, Segment]],
) -> dict[SegmentKind, Reference]:
    """Return for each kind of segment what it is carried by."""
    by_kind: defaultdict[SegmentKind, list[_Ending]] = defaultdict(list)
    for demonstration, segment in segments:
        by_kind[segment.kind].append(_Ending(demonstration, segment))
    return {kind: _reference(kind, endings) for kind, endings in by_kind.items()}


def _reference(kind: SegmentKind, endings: Sequence[_Ending]) -> Reference:
    if not kind.closed and kind.end != CLOSES:
        return Reference(TOOL)  # a hand that draws back
    things = [thing for thing in endings[0].demonstration.things if not _is_carried(thing, endings)]
    orders = {thing: turn_order(_turns(thing, endings)) for thing in things}
    if len(endings) < _FEWEST:
        if kind.end != CLOSES:
            return Reference(TOOL)
        nearest = min(things, key=lambda thing: _distance_m(thing, endings), default=None)
        return Reference(TOOL) if nearest is None else Reference(nearest, orders[nearest])
    spreads = {thing: _spread_m(_in_thing(thing, orders[thing], endings), endings) for thing in things}
    spreads[WORLD] = _spread_m([one.places_m for one in endings], endings)
    if kind.end != CLOSES:
        spreads[TOOL] = _spread_m([one.places_m - one.begin_m for one in endings], endings)
    best = min(spreads, key=lambda frame: spreads[frame])
    if spreads.get(TOOL, math.inf) <= _TIE * spreads[best] + _ALIKE_M:
        return Reference(TOOL)
    if kind.end == CLOSES or best in orders:
        for thing in _best_first(things, orders, spreads):
            if spreads[thing] <= _AS_GOOD * spreads[best] + _ALIKE_M:
                return Reference(thing, orders[thing])
    return Reference(best, orders.get(best, 1))


def _best_first(things: Sequence[str], orders: Mapping[str, int], spreads: Mapping[str, float]) -> list[str]:
    """Sort things by how close ends lie in their frames; those that are turned with come first."""
    return sorted(things, key=lambda thing: (orders[thing] == _ANY_TURN, spreads[thing]))


def turn_order(turns_rad: Sequence[float]) -> int:
    """Return how often things look the same in a turn that are gripped at these turns; 0 where no turn is preferred."""
    if not turns_rad:
        return _ANY_TURN
    for order, most_rad in _SPREADS_RAD.items():
        mean = abs(np.exp(1j * order * np.asarray(turns_rad)).mean())
        if math.sqrt(max(0.0, -2.0 * math.log(max(mean, 1e-12)))) / order < most_rad:
            return order
    return _ANY_TURN


def _turns(thing: str, endings: Sequence[_Ending]) -> list[float]:
    """Return how far the tool was turned from the thing; arms stand at other sides, so the first arm's are taken."""
    arm = endings[0].segment.arm
    found = [(one.tool_yaw, one.thing_yaw(thing)) for one in endings if one.segment.arm == arm]
    return [tool - yaw for tool, yaw in found if yaw is not None]


def _is_carried(thing: str, endings: Sequence[_Ending]) -> bool:
    with_tool = sum(one.segment.kind.closed and one.goes_with(thing) for one in endings)
    return 2 * with_tool > len(endings)


def _distance_m(thing: str, endings: Sequence[_Ending]) -> float:
    return float(np.mean([np.linalg.norm(one.places_m[0] - one.thing_m(thing)) for one in endings]))


def _in_thing(thing: str, order: int, endings: Sequence[_Ending]) -> list[Array]:
    found = []
    for one in endings:
        yaw = one.thing_yaw(thing)
        offsets = one.places_m - one.thing_m(thing)
        is_turned = order != _ANY_TURN and yaw is not None
        found.append(np.array([turned(one, -(yaw or 0.0)) for one in offsets]) if is_turned else offsets)
    return found


def _spread_m(places: Sequence[Array], endings: Sequence[_Ending]) -> float:
    """Return how far, in the median, places lie from their middle, each arm's from its own."""
    by_arm: Mapping[str, list[Array]] = defaultdict(list)
    for place, one in zip(places, endings, strict=True):
        by_arm[one.segment.arm].append(place)
    return float(np.mean([_from_middle_m(np.array(of_arm)) for of_arm in by_arm.values()]))


def _from_middle_m(places: Array) -> float:
    """Return the distance, of all places of a way together; places: shape (ways, 1 or 2, 3)."""
    return float(np.median(np.linalg.norm(places - np.median(places, axis=0), axis=-1), axis=0).sum())
