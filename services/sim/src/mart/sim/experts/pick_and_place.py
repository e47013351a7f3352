"""A thing in the hand of a person: gripping it, bringing it to its place, letting it go."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mart.protocol.pose import Pose
from mart.sim.experts.human_error import Person
from mart.sim.experts.perception import See, across, apart_m, at
from mart.sim.experts.plan import CLOSED, OPEN, Sight, Step, Until, Waypoint, go, never, pick, stay

_LOST_M = 0.035
_MISSED = 0.93  # of the gripper: fingers that have closed on nothing
_PACE, _CAREFUL = 0.7, 0.4

# A loaded arm sags by some millimetres. People look at the thing and not at the tool, and add what is still missing.
_TRIM_PER_S, _TRIM_FROM_M, _TRIM_MAX_M = 1.5, 0.03, 0.02
_ALIGNED_M, _ALIGNED_RAD = 0.004, 0.06  # give or take one's tremor
_LIFTED_M = 0.03  # below where it is lifted to: high enough to go on
_PRESS_M = 0.004  # below its place, so that it gets there in spite of friction
_PATIENCE_S = 4.0
_OPENING_S = 0.35


class Grip:
    """`thing` and `tool` tell, in the own base frame, where the thing is and where a tool is that grips it well.

    hangs: whether it turns in the hand as it likes; the hand then stays straight instead of leaning with it.
    """

    def __init__(self, person: Person, thing: See, tool: See, *, hangs: bool = False) -> None:
        self._person, self._thing, self._tool, self._hangs = person, thing, tool, hangs

    def is_lost(self, now: Sight) -> bool:
        """The thing is not in the hand."""
        return now.gripper > _MISSED or apart_m(self._tool(now), now.pose_tool_in_base) > _LOST_M

    def pick(self, sight: Sight, unless: Until = never, beside_m: float = 0.0) -> Step:
        """One attempt, with the fingers so far beside the thing, which moves between them when they close."""

        def grasp(now: Sight) -> Pose:
            return self._tool(now) @ at(0.0, beside_m, 0.0)

        return (yield from pick(sight, self._person, grasp, unless=unless))

    def bring(
        self,
        sight: Sight,
        goal: See,
        until: Until,
        *,
        pace: Callable[[Sight], float] = lambda _: _PACE,
        patience_s: float = math.inf,
    ) -> Step:
        """The thing towards its goal: until `until` holds, it is lost, or `patience_s` have passed."""
        trim = np.zeros(3)
        last_s, give_up_s = sight.sim_time_s, sight.sim_time_s + patience_s
        while not (until(sight) or self.is_lost(sight)) and sight.sim_time_s < give_up_s:
            tool = sight.pose_tool_in_base
            target = goal(sight) @ self._thing(sight).inverse() @ tool
            if self._hangs:
                target = across(target, math.tau)
            missing = target.position - tool.position
            if float(np.linalg.norm(missing)) < _TRIM_FROM_M:
                trim = trim + _TRIM_PER_S * (sight.sim_time_s - last_s) * missing
                trim = np.clip(trim, -_TRIM_MAX_M, _TRIM_MAX_M)
            last_s = sight.sim_time_s
            sight = yield Waypoint(Pose(target.position + trim, target.quaternion_wxyz), CLOSED, pace(sight))
        return sight

    def raise_to(self, sight: Sight, z_m: float) -> Step:
        """Straight up, nearly as high as asked, which is high enough to go on; not down where it is higher."""
        here = self._thing(sight)
        up = at(0.0, 0.0, max(0.0, z_m - here.position[2])) @ here
        return (
            yield from self.bring(sight, lambda _: up, lambda now: apart_m(self._thing(now), up) < _LIFTED_M)
        )

    def put(self, sight: Sight, place: See, clear_m: float, placed: Until, *, caught: Until = never) -> Step:
        """Up to `clear_m` over the place, there and down, again where it got stuck; lets go. The thing may be lost.

        caught: that it hangs on to something, from which it is to be lifted off before it is brought any further.
        """

        def over(now: Sight) -> Pose:
            return at(0.0, 0.0, clear_m) @ place(now)

        def below(now: Sight) -> Pose:
            return at(0.0, 0.0, -_PRESS_M) @ place(now)

        def is_over(now: Sight) -> bool:
            height_m = self._thing(now).position[2] - place(now).position[2]
            return (self.is_over(now, place) and height_m > clear_m / 2) or caught(now)

        def is_down(now: Sight) -> bool:
            return placed(now) or caught(now)

        sight = yield from self.raise_to(sight, over(sight).position[2])
        while not (placed(sight) or self.is_lost(sight)):
            if caught(sight):
                sight = yield from self._lift_off(sight, clear_m)
                if caught(sight):
                    break
            sight = yield from self.bring(sight, over, is_over)
            sight = yield from self.bring(
                sight, below, is_down, pace=lambda _: _CAREFUL, patience_s=_PATIENCE_S
            )
        return (yield from self.let_go(sight))

    def _lift_off(self, sight: Sight, up_m: float) -> Step:
        up = Waypoint(at(0.0, 0.0, up_m) @ across(sight.pose_tool_in_base, math.tau), CLOSED, _PACE)
        sight = yield from go(sight, lambda _: up, patience_s=2.0)
        return (yield from stay(sight, up, self._person.settles_s()))

    def is_over(self, now: Sight, place: See) -> bool:
        """The thing is straight over its place, as far as this person can tell."""
        thing, skill = self._thing(now), self._person.skill
        off_m = float(np.linalg.norm((thing.position - place(now).position)[:2]))
        _, off_rad = thing.distance_to(place(now))
        return off_m < _ALIGNED_M + skill.tremor_m and off_rad < _ALIGNED_RAD + skill.tremor_rad

    def let_go(self, sight: Sight, up_m: float = 0.12) -> Step:
        """Opens, and goes straight up where the thing is not far below already."""
        here = sight.pose_tool_in_base
        sight = yield from stay(sight, Waypoint(here, OPEN), _OPENING_S + self._person.settles_s())
        if here.position[2] - self._tool(sight).position[2] > up_m:
            return sight
        up = Waypoint(at(0.0, 0.0, up_m) @ here, OPEN)
        return (yield from go(sight, lambda _: up, patience_s=2.0))
