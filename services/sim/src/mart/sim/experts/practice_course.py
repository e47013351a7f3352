"""Plan the practice course: one station after another, then the plank together with the partner."""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.protocol.tasks.practice_course import PLANK_GOAL_M
from mart.sim.experts.carrying import Carrier
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.perception import ObservedPose, across, at, seen
from mart.sim.experts.pick_and_place import PickAndPlace
from mart.sim.experts.plan import OPEN, ExpertPlan, OperatorObservation, PlanStep, Until, Waypoint, go, wait

_REACH, _TURN, _GRIP, _CARRY = range(4)
_QUARTER_RAD = math.pi / 2
_CUBE_HALF_M = 0.02
_OVER_DISH_M, _RAISED_Z_M = 0.08, 0.10
_IN_DISH_M, _LOW_M = 0.03, 0.005
_UP_M, _THERE_M = 0.02, 0.03


def plan(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Yield the waypoints of one arm."""
    number = arm.name.removeprefix("arm")
    ball, bar = seen(arm, f"ball{number}"), seen(arm, f"bar{number}")

    def is_done(station: int) -> Until:
        return lambda now: bool(now.observations[f"stations{number}/done"][station])

    while not is_done(_REACH)(obs):
        obs = yield from _come_to(obs, lambda now: at(*ball(now).position), human, is_done(_REACH))
    while not is_done(_TURN)(obs):
        obs = yield from _come_to(obs, lambda now: across(bar(now)), human, is_done(_TURN))
    cube = _Cube(arm, human)
    while not is_done(_CARRY)(obs):
        obs = yield from cube.carry(obs, is_done(_GRIP), is_done(_CARRY))
    if "plank/position_in_world" in obs.observations:
        yield from _carry_together(arm, human, obs)
    while True:
        obs = yield Waypoint(obs.pose_tool_in_base, OPEN, pace=0.0)


def _come_to(obs: OperatorObservation, mark: ObservedPose, human: HumanErrorModel, done: Until) -> PlanStep:
    """Go to a mark and stay until the station is done."""
    obs = yield from go(obs, lambda now: Waypoint(mark(now), OPEN), unless=done)
    return obs if done(obs) else (yield from wait(obs, Waypoint(mark(obs), OPEN), human, done))


class _Cube:
    """Carry the own cube into its dish."""

    def __init__(self, arm: Arm, human: HumanErrorModel) -> None:
        number = arm.name.removeprefix("arm")
        self._cube, self._dish = seen(arm, f"cube{number}"), seen(arm, f"dish{number}")
        self._hand = PickAndPlace(human, self._cube, lambda now: across(self._cube(now), _QUARTER_RAD))

    def carry(self, obs: OperatorObservation, gripped: Until, done: Until) -> PlanStep:
        """Try once to lift it, until that is seen, and to put it into the dish."""
        obs = yield from self._hand.pick(obs)
        up = at(0.0, 0.0, _RAISED_Z_M) @ self._cube(obs)
        obs = yield from self._hand.bring(obs, lambda _: up, gripped)
        if self._hand.is_lost(obs):
            return (yield from self._hand.let_go(obs))
        obs = yield from self._hand.put(obs, self._place, _OVER_DISH_M, self._is_in_dish)
        away = Waypoint(obs.pose_tool_in_base, OPEN)
        return (yield from go(obs, lambda _: away, patience_s=1.0, unless=done))

    def _place(self, now: OperatorObservation) -> Pose:
        """Return where the cube is to lie, turned as it is."""
        x, y, _ = self._dish(now).position
        return Pose(np.array([x, y, _CUBE_HALF_M]), across(self._cube(now), _QUARTER_RAD).quaternion_wxyz)

    def _is_in_dish(self, now: OperatorObservation) -> bool:
        x, y, z = self._cube(now).position - self._place(now).position
        return math.hypot(x, y) < _IN_DISH_M and z < _LOW_M


def _carry_together(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Grip the own handle, wait for the partner, and carry the plank to where it is wanted, up first."""
    carrier, plank = Carrier(arm, human), seen(arm, "plank")
    goal = arm.pose_base_in_world.inverse().transform_points(PLANK_GOAL_M)
    while True:
        obs = yield from carrier.pick(obs)
        obs = yield from carrier.await_partner(obs)
        while not carrier.has_lost(obs):
            missing = goal - plank(obs).position
            is_low = missing[2] > _UP_M
            shift = np.array([0.0, 0.0, missing[2]]) if is_low else missing
            end = plank(obs).position + shift
            # A partner who is up already goes on aside: what is low is there when it is up.
            counts = np.array([0.0, 0.0, 1.0]) if is_low else np.ones(3)

            def arrived(now: OperatorObservation, end: np.ndarray = end, counts: np.ndarray = counts) -> bool:
                return float(np.linalg.norm(counts * (end - plank(now).position))) < _UP_M

            obs = yield from carrier.along(obs, shift, arrived)
            if not is_low and arrived(obs):
                obs = yield Waypoint(obs.pose_tool_in_base, 1.0)
