"""Write a scripted operator's plan as a generator: it is sent what the operator sees and yields waypoints.

A plan is written like a recipe, `plan(arm, human, obs)`, of five steps; each ends with what is seen then:

    obs = yield from pick(obs, human, grasp)              # one attempt to grip a thing, with this person's errors
    obs = yield from go(obs, lambda now: Waypoint(...))   # until the tool is there
    obs = yield from wait(obs, waypoint, human, until)    # until something is seen, noticed as late as people do
    obs = yield from stay(obs, waypoint, duration_s)      # for a while
    obs = yield waypoint                                  # for one tick

A plan looks again after each attempt and begins anew where the thing is not in the hand: any of them may fail. Errors,
tremor, pauses and slips come from the person and the hand; a plan adds none. Poses are in the arm's own base frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.experts.human_error import HumanErrorModel

OPEN, CLOSED = 0.0, 1.0
_CAREFUL = 0.6  # the pace of going down onto something
_OVER_HAND_M = 0.06  # over what somebody holds out: as low as can be, for it may be high up or far away
_PATIENCE_S = 2.5  # a tool that does not get where it should by then is standing on something


@dataclass(frozen=True)
class Waypoint:
    """Say where the tool should go (own base frame), what the gripper should do, and at what pace (1: usual speed)."""

    pose_tool_in_base: Pose
    gripper: float
    pace: float = 1.0


@dataclass(frozen=True)
class OperatorObservation:
    """Hold what one operator sees at one moment; `arrived`: the tool is at the waypoint yielded last.

    told_to_go: a partner has just said that one may go on, whatever is to be seen.
    """

    observations: Mapping[str, NDArray[np.float64]]
    sim_time_s: float
    pose_tool_in_base: Pose
    gripper: float
    arrived: bool
    told_to_go: bool = False


ExpertPlan = Generator[Waypoint, OperatorObservation, None]
PlanStep = Generator[Waypoint, OperatorObservation, OperatorObservation]
Aim = Callable[[OperatorObservation], Waypoint]
Until = Callable[[OperatorObservation], bool]


def never(_: OperatorObservation) -> bool:
    """Never hold: the condition of a step that nothing ends."""
    return False


def go(
    obs: OperatorObservation,
    aim: Aim,
    patience_s: float = math.inf,
    short_m: float = 0.0,
    unless: Until = never,
) -> PlanStep:
    """Go until the tool is there, or `short_m` before it, or `patience_s` have passed; the aim follows what is seen.

    unless: what makes it pointless to go on.
    """
    give_up_s = obs.sim_time_s + patience_s
    while True:
        waypoint = aim(obs)
        obs = yield waypoint
        left_m, _ = waypoint.pose_tool_in_base.distance_to(obs.pose_tool_in_base)
        if obs.arrived or left_m < short_m or obs.sim_time_s >= give_up_s or unless(obs):
            return obs


def stay(obs: OperatorObservation, waypoint: Waypoint, duration_s: float) -> PlanStep:
    """Stay at a waypoint for `duration_s`."""
    until_s = obs.sim_time_s + duration_s
    while obs.sim_time_s < until_s:
        obs = yield waypoint
    return obs


def wait(obs: OperatorObservation, waypoint: Waypoint, human: HumanErrorModel, until: Until) -> PlanStep:
    """Wait at `waypoint` until `until` holds or a partner says go; acted upon as late as this person notices things."""
    while not (until(obs) or obs.told_to_go):
        obs = yield waypoint
    return (yield from stay(obs, waypoint, human.notices_s()))


def pick(
    obs: OperatorObservation,
    human: HumanErrorModel,
    grasp: Callable[[OperatorObservation], Pose],
    over_m: float = 0.10,
    unless: Until = never,
    *,
    moves: bool = False,
) -> PlanStep:
    """Try once to grip something: over it, down onto it, close. Look afterwards whether it is in the hand.

    grasp: the tool's pose (base frame) that would grip it well; followed until the tool goes down, fixed from then on.
    unless: what makes the attempt pointless while it is under way.
    moves: whether somebody holds it, who never stands quite still: it is followed until the fingers close.
    """
    miss = human.aims()
    over_m, short_m = (_OVER_HAND_M, _OVER_HAND_M / 2) if moves else (over_m, 0.0)
    above = Pose(np.array([0.0, 0.0, human.varied(over_m)]), Pose.identity().quaternion_wxyz)

    def over(now: OperatorObservation) -> Waypoint:
        return Waypoint(above @ grasp(now) @ miss, OPEN)

    obs = yield from go(obs, over, short_m=short_m, unless=unless)
    if unless(obs):
        return obs
    obs = yield from stay(obs, over(obs), human.settles_s())
    place = grasp(obs) @ miss

    def down(now: OperatorObservation) -> Waypoint:
        return Waypoint(grasp(now) @ miss if moves else place, OPEN, _CAREFUL)

    obs = yield from go(obs, down, _PATIENCE_S, human.closes_before_m(), unless if moves else never)
    if moves:
        if unless(obs):
            return obs
        place = grasp(obs) @ miss
    return (yield from stay(obs, Waypoint(place, CLOSED), human.grips_s()))
