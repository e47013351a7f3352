"""Carry one segment of a demonstration into another world, tick by tick. Pure.

A segment begins as the way before it went on, and is led over, with least jerk along its path, into the frame of the
thing that it acts on: early enough that the last stretch to the thing is carried whole, and so late that fingers which
have just closed or opened first leave as they did. What stands still is looked at until the way has been led over; what
moves by another's hand is followed to the end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mart.protocol.pose import Array, quaternion_conjugate, quaternion_multiply
from mart.recorder.multiply.demonstration import Demonstration, ToolInWorld
from mart.recorder.multiply.references import TOOL, WORLD, Reference
from mart.recorder.multiply.segments import Segment
from mart.recorder.multiply.transport import between, carried, folded, min_jerk, yaw_of, yaw_quaternion

_CONTACT_M, _CONTACT_SHARE = 0.13, 0.5  # of the path, before its end
_LEAVING_M, _LEAVING_SHARE = 0.04, 0.25  # of the path, after its begin
_LEAD_OVER_M = 0.35  # of the path
_MOVES_M = 0.01
_STILL_M = 1e-4


@dataclass(frozen=True)
class Placed:
    """Say where a thing is now, in the world; yaw_rad: None where its turn is not observed."""

    position: Array
    yaw_rad: float | None


class CarriedSegment:
    """Carry a segment from where the tool was led last.

    last: the target before it. origin: that of the demonstration. in_contact: whether the fingers have just closed or
    opened.
    """

    def __init__(
        self,
        demonstration: Demonstration,
        segment: Segment,
        reference: Reference,
        last: ToolInWorld,
        origin: ToolInWorld,
        *,
        in_contact: bool,
    ) -> None:
        self.segment = segment
        self._way = demonstration.ways[segment.arm]
        self._reference = reference
        self._start, self._origin = last.position, origin.position
        self._turn = quaternion_multiply(last.quaternion, quaternion_conjugate(origin.quaternion))
        self._yaw = yaw_of(self._turn)
        self._thing = demonstration.things.get(reference.frame)
        self._follows = self._moves_meanwhile()
        self._shares = shares_led_over(
            self._way.positions[segment.begin : segment.end], in_contact=in_contact
        )
        self._frozen: tuple[Array, Array, float] | None = None

    def target(self, tick: float, placed: Mapping[str, Placed]) -> ToolInWorld:
        """Return where the tool is to be at a tick of the demonstration, which may lie between two.

        placed: where things are now, by name.
        """
        shown = self._way.at(min(tick, self.segment.end - 1.0))
        before = ToolInWorld(
            carried(shown.position, self._origin, self._start, self._yaw),
            quaternion_multiply(self._turn, shown.quaternion),
            shown.gripper,
        )
        if self._reference.frame == TOOL:
            return before
        share = self._share(tick)
        after = self._in_frame(tick, shown, before, placed)
        return ToolInWorld(
            before.position + share * (after.position - before.position),
            between(before.quaternion, after.quaternion, share),
            shown.gripper,
        )

    def demonstrated_m(self, tick: float, later: float) -> float:
        """Return how far the demonstration led the tool between two of its ticks, metres."""
        return float(np.linalg.norm(self._way.at(later).position - self._way.at(tick).position))

    def _in_frame(
        self, tick: float, shown: ToolInWorld, before: ToolInWorld, placed: Mapping[str, Placed]
    ) -> ToolInWorld:
        """Return the target as the thing carries it, or the world; where no turn counts, turned as the way before."""
        if self._reference.frame == WORLD:
            return shown
        origin, now, yaw = self._frozen or self._frames(tick, placed[self._reference.frame])
        if self._share(tick) >= 1.0 and not self._follows:
            self._frozen = origin, now, yaw
        position = carried(shown.position, origin, now, yaw)
        if not self._reference.order:
            return ToolInWorld(position, before.quaternion, shown.gripper)
        return ToolInWorld(
            position, quaternion_multiply(yaw_quaternion(yaw), shown.quaternion), shown.gripper
        )

    def _frames(self, tick: float, now: Placed) -> tuple[Array, Array, float]:
        """Return the thing's place then and now, and how far it is turned now from then."""
        assert self._thing is not None
        row = min(int(tick), len(self._thing.positions) - 1)
        then = self._thing.positions[row]
        if not self._reference.order or now.yaw_rad is None or self._thing.quaternions is None:
            return then, now.position, 0.0
        turn = now.yaw_rad - yaw_of(self._thing.quaternions[row])
        return then, now.position, folded(turn, self._reference.order)

    def _moves_meanwhile(self) -> bool:
        if self._thing is None:
            return False
        moved = (
            self._thing.positions[self.segment.begin : self.segment.end]
            - self._thing.positions[self.segment.end - 1]
        )
        return bool(np.linalg.norm(moved, axis=1).max() > _MOVES_M)

    def _share(self, tick: float) -> float:
        place = min(tick - self.segment.begin, len(self._shares) - 1.0)
        row = int(place)
        following = min(row + 1, len(self._shares) - 1)
        return float(self._shares[row] + (place - row) * (self._shares[following] - self._shares[row]))


def shares_led_over(positions: Array, *, in_contact: bool) -> Array:
    """Return, for each tick of a path, shape (T, 3), how far it is led over into its thing's frame: 0 to 1, rising."""
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    path = np.concatenate([[0.0], np.cumsum(steps)])
    length = float(path[-1])
    begin = min(_LEAVING_M, _LEAVING_SHARE * length) if in_contact else 0.0
    end = length - min(_CONTACT_M, _CONTACT_SHARE * length)
    end = min(end, begin + _LEAD_OVER_M)
    if end - begin < _STILL_M:  # it hardly moves: led over in time
        return np.array([min_jerk(share) for share in np.linspace(0.0, 1.0, len(positions))])
    return np.array([min_jerk((at - begin) / (end - begin)) for at in path])
