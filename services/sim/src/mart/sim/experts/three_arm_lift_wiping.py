"""Plan lift and wipe: two carry the tray to the rack in step; the third waits with the sponge, then wipes.

An arm without fingers waits where it is and wipes with its own pad.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.protocol.tasks.three_arm_lift_wiping import ASIDE_Y_M, RACK_TOP_M, SPOTS_M, WIPER
from mart.sim.experts.carrying import Carrier, raised
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.perception import apart_m, at, seen
from mart.sim.experts.plan import (
    CLOSED,
    OPEN,
    ExpertPlan,
    OperatorObservation,
    PlanStep,
    Waypoint,
    pick,
    stay,
    wait,
)

_RACK_TRAY_M = np.add(RACK_TOP_M, (0.0, 0.0, 0.002))  # of the tray on it, put down with a little force
_CARRY_Z_M = 0.105  # of the tray, on its way: not higher than the rack asks for, in case somebody lets go
_NEAR_M = 0.02

_SPOTS_M = np.array([(x, y, 0.0) for x, y in SPOTS_M])
_SPONGE_Z_M, _SPONGE_LENGTH_M = 0.015, 0.09  # of its middle when it lies on the table
_BLOCK = at(0.0, 0.0, 0.035)  # what to hold it by, in its frame
_LOST_M = 0.04  # a block further from the tool than this is not in the hand
_OVER_M = 0.10
_PRESS_M, _PRESS_MORE_M_PER_S, _PRESS_MOST_M = 0.004, 0.003, 0.010
_PACE = 0.8

Vector = NDArray[np.float64]


def plan(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Yield the waypoints of one arm: the wiper's, or a carrier's."""
    return _wipe(arm, human, obs) if arm.name == WIPER else _carry(arm, human, obs)


def _carry(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    carrier, tray = Carrier(arm, human), seen(arm, "tray")
    rack = arm.pose_base_in_world.inverse().transform_points(_RACK_TRAY_M)

    def beside(now: OperatorObservation) -> Vector:
        return (rack - tray(now).position) * (1, 1, 0)

    def is_up(now: OperatorObservation) -> bool:
        return bool(tray(now).position[2] > _CARRY_Z_M - _NEAR_M)

    def is_over_rack(now: OperatorObservation) -> bool:
        return float(np.linalg.norm(beside(now))) < _NEAR_M

    while True:
        obs = yield from carrier.pick(obs)
        obs = yield from carrier.await_partner(obs)
        if not is_over_rack(obs):
            up = np.array([0.0, 0.0, _CARRY_Z_M - tray(obs).position[2]])
            obs = yield from carrier.along(obs, up, is_up)
            obs = yield from carrier.along(obs, beside(obs), is_over_rack)
        down = np.array([0.0, 0.0, rack[2] - tray(obs).position[2]])
        obs = yield from carrier.along(obs, down, lambda _: False)


def _wipe(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    wiper = _Wiper(arm, human)
    while True:
        if arm.kind.has_fingers:
            obs = yield from pick(obs, human, wiper.grip)
        obs = yield from wiper.wait_aside(obs)
        obs = yield from wiper.rub(obs)
        obs = yield from stay(obs, Waypoint(obs.pose_tool_in_base, OPEN), human.settles_s())


class _Wiper:
    """Wipe as the third operator, with a sponge or the own pad; all poses are in the arm's own base frame."""

    def __init__(self, arm: Arm, human: HumanErrorModel) -> None:
        self._human = human
        face = arm.kind.end_effector.wiping
        self._grips = arm.kind.has_fingers or face is None
        self._gripper = CLOSED if self._grips else OPEN
        if self._grips or face is None:
            self._sponge, self._length_m, self._lying_z_m = seen(arm, "sponge"), _SPONGE_LENGTH_M, _SPONGE_Z_M
        else:
            self._sponge, self._length_m, self._lying_z_m = _own_tool, 2 * face.half_m[0], face.below_tool_m
        self._spots = arm.pose_base_in_world.inverse().transform_points(_SPOTS_M)

    def grip(self, now: OperatorObservation) -> Pose:
        return self._sponge(now) @ _BLOCK

    def wait_aside(self, obs: OperatorObservation) -> PlanStep:
        """Hold the sponge up until the tray has left the dirt."""
        up_m = _OVER_M if self._grips else 0.0
        up = Waypoint(raised(obs.pose_tool_in_base, up_m), self._gripper, _PACE)

        def has_news(now: OperatorObservation) -> bool:
            return _is_aside(now) or self.has_lost(now)

        return (yield from wait(obs, up, self._human, has_news))

    def rub(self, obs: OperatorObservation) -> PlanStep:
        """Rub what is nearest and still dirty, harder where it does not come off; then go up, and stay so."""
        since_s, left = obs.sim_time_s, len(self._spots)
        offset = obs.pose_tool_in_base.position - self._sponge(obs).position
        turn = obs.pose_tool_in_base.quaternion_wxyz
        while not self.has_lost(obs):
            dirty = self._spots[obs.observations["dirt/wiped"] < 1]
            if len(dirty) < left:
                since_s, left = obs.sim_time_s, len(dirty)
            place = self._next_place(obs, dirty, obs.sim_time_s - since_s)
            obs = yield Waypoint(Pose(place + offset, turn), self._gripper, _PACE)
        return obs

    def has_lost(self, now: OperatorObservation) -> bool:
        return self._grips and apart_m(self.grip(now), now.pose_tool_in_base) > _LOST_M

    def _next_place(self, now: OperatorObservation, dirty: Vector, stuck_s: float) -> Vector:
        """Return where the sponge's middle should be, shape (3,), metres."""
        x, y, _ = self._sponge(now).position
        if len(dirty) == 0 or not _is_aside(now):
            return np.array([x, y, _OVER_M])
        away_m = np.hypot(dirty[:, 0] - x, dirty[:, 1] - y)
        nearest_x, nearest_y, _ = dirty[np.argmin(away_m)]
        if away_m.min() > self._length_m:
            return np.array([nearest_x, nearest_y, _OVER_M / 2])
        press_m = min(_PRESS_M + _PRESS_MORE_M_PER_S * stuck_s, _PRESS_MOST_M)
        return np.array([nearest_x, nearest_y, self._lying_z_m - press_m])


def _own_tool(now: OperatorObservation) -> Pose:
    return now.pose_tool_in_base


def _is_aside(now: OperatorObservation) -> bool:
    return bool(now.observations["tray/position_in_world"][1] < ASIDE_Y_M)
