"""Plan multi-cube lifting: lift the own cube; pick it up once more where it was missed, slipped or dropped."""

from __future__ import annotations

import math

import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.sim.experts.human_error import HumanErrorModel
from mart.sim.experts.plan import CLOSED, OPEN, ExpertPlan, OperatorObservation, Waypoint, pick, stay, wait

_LIFT_Z_M = 0.17  # of the cube's centre; 12 cm would do
_LOST_M = 0.05  # a cube further from the tool than this is not in the hand


def plan(arm: Arm, human: HumanErrorModel, obs: OperatorObservation) -> ExpertPlan:
    """Yield the waypoints of one arm."""
    cube = arm.name.replace("arm", "cube")
    base_from_world = arm.pose_base_in_world.inverse()

    def cube_in_base(now: OperatorObservation) -> Pose:
        return base_from_world @ Pose(
            now.observations[f"{cube}/position_in_world"], now.observations[f"{cube}/quaternion_in_world"]
        )

    def lost(now: OperatorObservation) -> bool:
        return float(np.linalg.norm(cube_in_base(now).position - now.pose_tool_in_base.position)) > _LOST_M

    while True:
        obs = yield from pick(obs, human, lambda now: grip(cube_in_base(now)))
        here = obs.pose_tool_in_base
        up = Pose(np.array([*here.position[:2], _LIFT_Z_M]), here.quaternion_wxyz)
        obs = yield from wait(obs, Waypoint(up, CLOSED, pace=0.8), human, lost)
        obs = yield from stay(obs, Waypoint(up, OPEN), human.settles_s())


def grip(thing_in_base: Pose) -> Pose:
    """Return the tool that grips a cube: pointing down, fingers across a side, turned by at most 45 degrees."""
    rotation = thing_in_base.rotation_matrix()
    flattest = rotation[:, int(np.argmin(np.abs(rotation[2])))]
    quarter = math.pi / 2
    yaw = (math.atan2(flattest[1], flattest[0]) + quarter / 2) % quarter - quarter / 2
    return Pose(thing_in_base.position, np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]))
