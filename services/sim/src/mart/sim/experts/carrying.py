"""One arm's part in carrying a tray by its two handles, in step with a partner whom it only sees."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.protocol.tasks.tray import handle_of, partner_of
from mart.sim.experts.human_error import Person
from mart.sim.experts.perception import apart_m, seen, seen_tool, upright
from mart.sim.experts.plan import CLOSED, OPEN, Sight, Step, Waypoint, go, pick, stay, wait

_AWAY_M = 0.05  # a tool further than this from a handle does not hold it
_MISSED = 0.92  # of the gripper: fingers that have closed on nothing
_LEAD_M = 0.04  # how far one goes before seeing the partner follow
_PACE = 0.8
_CLEAR_M = 0.12
_PATIENCE_S = 2.0

Vector = NDArray[np.float64]


class Carrier:
    """What one carrier sees and does; everything is in the arm's own base frame."""

    def __init__(self, arm: Arm, person: Person) -> None:
        self._person = person
        partner = partner_of(arm.name)
        self._handle, self._partner_handle = (
            seen(arm, handle_of(arm.name)),
            seen(arm, handle_of(partner)),
        )
        self._partner_tool = seen_tool(arm, partner)

    def pick(self, sight: Sight) -> Step:
        """Attempts at the own handle until it is in the hand."""
        while True:
            sight = yield from pick(sight, self._person, self._grip)
            if not self.has_lost(sight):
                return sight
            sight = yield from self._let_go(sight)

    def await_partner(self, sight: Sight) -> Step:
        """Until the partner's tool has come to its handle, and a moment longer: fingers close slowly."""
        here = Waypoint(sight.pose_tool_in_base, CLOSED)
        sight = yield from wait(sight, here, self._person, lambda now: not self.is_alone(now))
        return (yield from stay(sight, here, self._person.grips_s()))

    def along(self, sight: Sight, shift: Vector, until: Callable[[Sight], bool]) -> Step:
        """Moves the own handle by `shift` (metres), never far ahead of the partner's.

        Ends when `until` holds or the handle is lost. Where the partner lets go, it goes back to where it began.
        """
        tool = sight.pose_tool_in_base
        way_m = float(np.linalg.norm(shift))
        forward = shift / way_m
        # The partner is to come as far as this arm, from beside it: level with it, whatever the tray is now.
        beside = (self._partner_handle(sight).position - self._handle(sight).position) * (1, 1, 0)
        partner_start = self._handle(sight).position + beside
        while not (until(sight) or self.has_lost(sight)):
            followed_m = float((self._partner_handle(sight).position - partner_start) @ forward)
            lead_m = 0.0 if self.is_alone(sight) else _LEAD_M
            done_m = min(max(followed_m + lead_m, 0.0), way_m)
            goal = Pose(tool.position + done_m * forward, tool.quaternion_wxyz)
            sight = yield Waypoint(goal, CLOSED, _PACE)
        return sight

    def has_lost(self, now: Sight) -> bool:
        return apart_m(self._handle(now), now.pose_tool_in_base) > _AWAY_M or now.gripper > _MISSED

    def is_alone(self, now: Sight) -> bool:
        """The partner's tool is not at its handle."""
        return apart_m(self._partner_handle(now), self._partner_tool(now)) > _AWAY_M

    def _let_go(self, sight: Sight) -> Step:
        """Opens and goes up, so as to take the tray with it as little as can be."""
        here = sight.pose_tool_in_base
        sight = yield from stay(sight, Waypoint(here, OPEN), self._person.settles_s())
        up = Waypoint(raised(here, _CLEAR_M), OPEN, _PACE)
        return (yield from go(sight, lambda _: up, _PATIENCE_S))

    def _grip(self, now: Sight) -> Pose:
        """The tool that grips the own handle: fingers across the bar, which lies across the line between handles."""
        handle = self._handle(now).position
        x, y, _ = handle - self._partner_handle(now).position
        return upright(handle, (math.atan2(y, x) + math.pi / 2) % math.pi)


def raised(pose: Pose, height_m: float) -> Pose:
    return Pose(pose.position + np.array([0.0, 0.0, height_m]), pose.quaternion_wxyz)
