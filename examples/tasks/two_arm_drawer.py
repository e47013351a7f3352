"""What scripts do in two_arm_drawer: orange holds the drawer open until blue has put the peg into it."""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.perception import ObservedPose, across, apart_m, at, seen, upright
from mart.sim.experts.plan import (
    CLOSED,
    OPEN,
    ExpertPlan,
    OperatorObservation,
    PlanStep,
    Waypoint,
    go,
    pick,
    stay,
    wait,
)

_PULL_M = 0.125  # of the drawer, which opens towards its own -y
_OPEN_M = 0.09
_IN_HAND_M = 0.05
_CLOSED_ON_NOTHING = 0.93
_PATIENCE_S = 2.5
_ASIDE_M = -0.035  # where the peg goes, from the drawer's middle: away from the handle


def plan(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Put the peg in as arm0, hold the drawer as arm1."""
    return _puts(arm, human, obs) if arm.name == "arm0" else _holds(arm, human, obs)


def _puts(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    peg, drawer = seen(arm, "peg"), seen(arm, "drawer")
    while True:
        while not _in_hand(peg, obs):
            obs = yield from pick(obs, human, lambda now: across(peg(now), math.pi / 2))
        up = Waypoint(_raised(obs, 0.14), CLOSED)
        obs = yield from _to(obs, up)
        obs = yield from wait(obs, up, human, _is_open)
        miss = human.aims()
        place = (drawer(obs) @ at(_ASIDE_M, 0.0, 0.0)).position
        over = upright(place + np.array([0.0, 0.0, 0.16]), 0.0) @ miss
        down = upright(place + np.array([0.0, 0.0, 0.075]), 0.0) @ miss
        obs = yield from _to(obs, Waypoint(over, CLOSED))
        obs = yield from _to(obs, Waypoint(down, CLOSED, 0.6))
        obs = yield from stay(obs, Waypoint(down, OPEN), human.grips_s())
        away = Waypoint(upright(down.position + np.array([-0.12, 0.0, 0.12]), 0.0), OPEN)
        obs = yield from _to(obs, away)
        obs = yield from wait(obs, away, human, lambda now: not _is_filled(drawer(now), peg(now)))


def _holds(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    handle, peg, drawer = seen(arm, "handle"), seen(arm, "peg"), seen(arm, "drawer")
    pull = arm.pose_base_in_world.rotation_matrix().T @ np.array([0.0, -_PULL_M, 0.0])

    def is_over(now: OperatorObservation) -> bool:
        return _is_filled(drawer(now), peg(now)) or not _in_hand(handle, now)

    while True:
        while not _in_hand(handle, obs):
            obs = yield from pick(obs, human, lambda now: upright(handle(now).position, 0.0))
        pulled = upright(obs.pose_tool_in_base.position + pull, 0.0)
        obs = yield from _to(obs, Waypoint(pulled, CLOSED, 0.7))
        obs = yield from wait(obs, Waypoint(pulled, CLOSED), human, is_over)
        obs = yield from stay(obs, Waypoint(pulled, CLOSED), 1.0)  # until the other hand is away
        obs = yield from stay(obs, Waypoint(pulled, OPEN), human.grips_s())
        away = Waypoint(_raised(obs, 0.12), OPEN)
        obs = yield from _to(obs, away)
        obs = yield from wait(obs, away, human, lambda now: not _is_filled(drawer(now), peg(now)))


def _to(obs: OperatorObservation, waypoint: Waypoint) -> PlanStep:
    return (yield from go(obs, lambda _: waypoint, _PATIENCE_S))


def _in_hand(thing: ObservedPose, now: OperatorObservation) -> bool:
    return apart_m(thing(now), now.pose_tool_in_base) < _IN_HAND_M and 0.2 < now.gripper < _CLOSED_ON_NOTHING


def _is_open(now: OperatorObservation) -> bool:
    return float(now.observations["drawer/position_in_world"][1]) < -_OPEN_M


def _is_filled(drawer: Pose, peg: Pose) -> bool:
    x, y, z = (drawer.inverse() @ peg).position
    return abs(x) < 0.075 and abs(y) < 0.056 and z < 0.045


def _raised(obs: OperatorObservation, height_m: float) -> Pose:
    return upright(obs.pose_tool_in_base.position + np.array([0.0, 0.0, height_m]), 0.0)
