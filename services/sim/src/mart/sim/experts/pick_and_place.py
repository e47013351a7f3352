"""Grip a thing, bring it to its place and let it go, as people do."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mart.protocol.pose import Pose
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.perception import ObservedPose, across, apart_m, at
from mart.sim.experts.plan import (
    CLOSED,
    OPEN,
    OperatorObservation,
    PlanStep,
    Until,
    Waypoint,
    go,
    never,
    pick,
    stay,
)

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


class PickAndPlace:
    """Handle one thing; `thing` and `tool` find, in the own base frame, it and a tool that grips it well.

    hangs: whether it turns in the hand as it likes; the hand then stays straight instead of leaning with it.
    """

    def __init__(
        self, human: HumanErrorModel, thing: ObservedPose, tool: ObservedPose, *, hangs: bool = False
    ) -> None:
        self._human, self._thing, self._tool, self._hangs = human, thing, tool, hangs

    def is_lost(self, now: OperatorObservation) -> bool:
        """Whether the thing is not in the hand."""
        return now.gripper > _MISSED or apart_m(self._tool(now), now.pose_tool_in_base) > _LOST_M

    def pick(
        self,
        obs: OperatorObservation,
        unless: Until = never,
        beside_m: float = 0.0,
        *,
        moves: bool = False,
    ) -> PlanStep:
        """Try once, with the fingers `beside_m` beside the thing, which moves between them when they close.

        unless, moves: see `plan.pick`.
        """

        def grasp(now: OperatorObservation) -> Pose:
            return self._tool(now) @ at(0.0, beside_m, 0.0)

        return (yield from pick(obs, self._human, grasp, unless=unless, moves=moves))

    def bring(
        self,
        obs: OperatorObservation,
        goal: ObservedPose,
        until: Until,
        *,
        pace: Callable[[OperatorObservation], float] = lambda _: _PACE,
        patience_s: float = math.inf,
    ) -> PlanStep:
        """Bring the thing towards its goal: until `until` holds, it is lost, or `patience_s` have passed."""
        trim = np.zeros(3)
        last_s, give_up_s = obs.sim_time_s, obs.sim_time_s + patience_s
        while not (until(obs) or self.is_lost(obs)) and obs.sim_time_s < give_up_s:
            tool = obs.pose_tool_in_base
            target = goal(obs) @ self._thing(obs).inverse() @ tool
            if self._hangs:
                target = across(target, math.tau)
            missing = target.position - tool.position
            if float(np.linalg.norm(missing)) < _TRIM_FROM_M:
                trim = trim + _TRIM_PER_S * (obs.sim_time_s - last_s) * missing
                trim = np.clip(trim, -_TRIM_MAX_M, _TRIM_MAX_M)
            last_s = obs.sim_time_s
            obs = yield Waypoint(Pose(target.position + trim, target.quaternion_wxyz), CLOSED, pace(obs))
        return obs

    def raise_to(self, obs: OperatorObservation, z_m: float) -> PlanStep:
        """Lift straight up, nearly as high as asked, which is enough to go on; not down where it is higher."""
        here = self._thing(obs)
        up = at(0.0, 0.0, max(0.0, z_m - here.position[2])) @ here
        return (
            yield from self.bring(obs, lambda _: up, lambda now: apart_m(self._thing(now), up) < _LIFTED_M)
        )

    def put(
        self,
        obs: OperatorObservation,
        place: ObservedPose,
        clear_m: float,
        placed: Until,
        *,
        caught: Until = never,
    ) -> PlanStep:
        """Go up to `clear_m` over the place, there and down, again where it got stuck; let go. It may be lost.

        caught: that it hangs on to something, from which it is to be lifted off before it is brought any further.
        """

        def over(now: OperatorObservation) -> Pose:
            return at(0.0, 0.0, clear_m) @ place(now)

        def below(now: OperatorObservation) -> Pose:
            return at(0.0, 0.0, -_PRESS_M) @ place(now)

        def is_over(now: OperatorObservation) -> bool:
            height_m = self._thing(now).position[2] - place(now).position[2]
            return (self.is_over(now, place) and height_m > clear_m / 2) or caught(now)

        def is_down(now: OperatorObservation) -> bool:
            return placed(now) or caught(now)

        obs = yield from self.raise_to(obs, over(obs).position[2])
        while not (placed(obs) or self.is_lost(obs)):
            if caught(obs):
                obs = yield from self._lift_off(obs, clear_m)
                if caught(obs):
                    break
            obs = yield from self.bring(obs, over, is_over)
            obs = yield from self.bring(obs, below, is_down, pace=lambda _: _CAREFUL, patience_s=_PATIENCE_S)
        return (yield from self.let_go(obs))

    def _lift_off(self, obs: OperatorObservation, up_m: float) -> PlanStep:
        up = Waypoint(at(0.0, 0.0, up_m) @ across(obs.pose_tool_in_base, math.tau), CLOSED, _PACE)
        obs = yield from go(obs, lambda _: up, patience_s=2.0)
        return (yield from stay(obs, up, self._human.settles_s()))

    def is_over(self, now: OperatorObservation, place: ObservedPose) -> bool:
        """Whether the thing is straight over its place, as far as this person can tell."""
        thing, skill = self._thing(now), self._human.skill
        off_m = float(np.linalg.norm((thing.position - place(now).position)[:2]))
        _, off_rad = thing.distance_to(place(now))
        return off_m < _ALIGNED_M + skill.tremor_m and off_rad < _ALIGNED_RAD + skill.tremor_rad

    def let_go(self, obs: OperatorObservation, up_m: float = 0.12) -> PlanStep:
        """Open, and go straight up where the thing is not far below already."""
        here = obs.pose_tool_in_base
        obs = yield from stay(obs, Waypoint(here, OPEN), _OPENING_S + self._human.settles_s())
        if here.position[2] - self._tool(obs).position[2] > up_m:
            return obs
        up = Waypoint(at(0.0, 0.0, up_m) @ here, OPEN)
        return (yield from go(obs, lambda _: up, patience_s=2.0))
