"""What a scripted operator wants next: a generator that is sent what it sees and yields waypoints.

A plan is written like a recipe, `plan(arm, person, sight)`, of five steps; each ends with what is seen then:

    sight = yield from pick(sight, person, grasp)             # one attempt to grip a thing, with this person's errors
    sight = yield from go(sight, lambda now: Waypoint(...))   # until the tool is there
    sight = yield from wait(sight, waypoint, person, until)   # until something is seen, noticed as late as people do
    sight = yield from stay(sight, waypoint, duration_s)      # for a while
    sight = yield waypoint                                    # for one tick

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
from mart.sim.experts.human_error import Person

OPEN, CLOSED = 0.0, 1.0
_CAREFUL = 0.6  # the pace of going down onto something
_PATIENCE_S = 2.5  # a tool that does not get where it should by then is standing on something


@dataclass(frozen=True)
class Waypoint:
    """Where the tool should go (own base frame) and what the gripper should do; `pace` 1 is the person's own speed."""

    pose_tool_in_base: Pose
    gripper: float
    pace: float = 1.0


@dataclass(frozen=True)
class Sight:
    """What one operator sees at one moment. `arrived`: the tool is at the waypoint that was yielded last."""

    observations: Mapping[str, NDArray[np.float64]]
    sim_time_s: float
    pose_tool_in_base: Pose
    gripper: float
    arrived: bool


Plan = Generator[Waypoint, Sight, None]
Step = Generator[Waypoint, Sight, Sight]
Aim = Callable[[Sight], Waypoint]
Until = Callable[[Sight], bool]


def never(_: Sight) -> bool:
    return False


def go(
    sight: Sight, aim: Aim, patience_s: float = math.inf, short_m: float = 0.0, unless: Until = never
) -> Step:
    """Until the tool is there, or `short_m` before it, or `patience_s` have passed; the aim follows what is seen.

    unless: what makes it pointless to go on.
    """
    give_up_s = sight.sim_time_s + patience_s
    while True:
        waypoint = aim(sight)
        sight = yield waypoint
        left_m, _ = waypoint.pose_tool_in_base.distance_to(sight.pose_tool_in_base)
        if sight.arrived or left_m < short_m or sight.sim_time_s >= give_up_s or unless(sight):
            return sight


def stay(sight: Sight, waypoint: Waypoint, duration_s: float) -> Step:
    """For a while."""
    until_s = sight.sim_time_s + duration_s
    while sight.sim_time_s < until_s:
        sight = yield waypoint
    return sight


def wait(sight: Sight, waypoint: Waypoint, person: Person, until: Until) -> Step:
    """At `waypoint`, until `until` holds; acted upon as late as this person notices things."""
    while not until(sight):
        sight = yield waypoint
    return (yield from stay(sight, waypoint, person.notices_s()))


def pick(
    sight: Sight,
    person: Person,
    grasp: Callable[[Sight], Pose],
    over_m: float = 0.10,
    unless: Until = never,
) -> Step:
    """One attempt to grip something: over it, down onto it, close. Look afterwards whether it is in the hand.

    grasp: the tool's pose (base frame) that would grip it well; followed until the tool goes down, fixed from then on.
    unless: what makes the attempt pointless while it is under way.
    """
    miss = person.aims()
    above = Pose(np.array([0.0, 0.0, person.varied(over_m)]), Pose.identity().quaternion_wxyz)

    def over(now: Sight) -> Waypoint:
        return Waypoint(above @ grasp(now) @ miss, OPEN)

    sight = yield from go(sight, over, unless=unless)
    if unless(sight):
        return sight
    sight = yield from stay(sight, over(sight), person.settles_s())
    place = grasp(sight) @ miss
    down = Waypoint(place, OPEN, _CAREFUL)
    sight = yield from go(sight, lambda _: down, _PATIENCE_S, person.closes_before_m())
    return (yield from stay(sight, Waypoint(place, CLOSED), person.grips_s()))
