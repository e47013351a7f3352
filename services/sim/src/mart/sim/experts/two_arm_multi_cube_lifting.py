"""Lifts the own cube: over it, down, close, up; once more where it slipped."""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.sim.experts.plan import CLOSED, OPEN, Aim, Plan, Sight, Waypoint, go, stay
from mart.sim.experts.skill import Skill

_HOVER_M = 0.10
_LIFT_Z_M = 0.17  # of the cube's centre; 12 cm would do
_CLOSING_S = 0.45
_LOST_M = 0.03  # a cube further from the tool than this is not in the hand


def lift_cube(arm: Arm, skill: Skill, sight: Sight) -> Plan:
    cube = arm.name.replace("arm", "cube")
    base_from_world = arm.pose_base_in_world.inverse()

    def cube_in_base(now: Sight) -> Pose:
        return base_from_world @ Pose(
            now.observations[f"{cube}/position_in_world"], now.observations[f"{cube}/quaternion_in_world"]
        )

    def held(now: Sight) -> bool:
        return float(np.linalg.norm(cube_in_base(now).position - now.pose_tool_in_base.position)) < _LOST_M

    while True:
        sight = yield from go(sight, lambda now: Waypoint(_over(cube_in_base(now), _HOVER_M), OPEN))
        sight = yield from stay(sight, Waypoint(_over(cube_in_base(sight), _HOVER_M), OPEN), skill.settle_s)
        grasp = _over(cube_in_base(sight), 0.0)
        sight = yield from go(sight, _straight_to(grasp))
        sight = yield from stay(sight, Waypoint(grasp, CLOSED), _CLOSING_S + skill.settle_s)
        up = Pose(np.array([*grasp.position[:2], _LIFT_Z_M]), grasp.quaternion_wxyz)
        sight = yield Waypoint(up, CLOSED, pace=0.8)
        while held(sight):
            sight = yield Waypoint(up, CLOSED, pace=0.8)
        sight = yield from stay(sight, Waypoint(up, OPEN), skill.settle_s)


def _straight_to(pose_tool_in_base: Pose) -> Aim:
    return lambda _: Waypoint(pose_tool_in_base, OPEN, pace=0.6)


def _over(cube_in_base: Pose, height_m: float) -> Pose:
    """Tool down, fingers across the cube, turned by at most 45 degrees."""
    rotation = cube_in_base.rotation_matrix()
    flattest = rotation[:, int(np.argmin(np.abs(rotation[2])))]
    quarter = math.pi / 2
    yaw = (math.atan2(flattest[1], flattest[0]) + quarter / 2) % quarter - quarter / 2
    return Pose(
        cube_in_base.position + np.array([0.0, 0.0, height_m]),
        np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]),
    )
