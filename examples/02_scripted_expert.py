"""Let a scripted expert of your own lift the cubes: one for each arm, each of which sees only what its arm sees.

$ .venv/bin/python examples/02_scripted_expert.py
"""

from __future__ import annotations

import math
from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from mart.envs import make_parallel_env
from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm

OVER_M, UP_M = np.array([0.0, 0.0, 0.10]), 0.16
OPEN, CLOSED = 0.0, 1.0
HELD = 0.45  # of the measured gripper: fingers that closed on a cube of 4 cm


class CubeLifter:
    """Go over the own cube, down, close, up; and again from the start where it was missed."""

    def __init__(self, arm: Arm) -> None:
        self._arm, self._cube = arm.name, arm.name.replace("arm", "cube")
        self._base_from_world = arm.pose_base_in_world.inverse()

    def act(self, obs: dict[str, NDArray[np.float64]]) -> tuple[Pose, float]:
        """Return where the tool should go, in the arm's base frame, and what the gripper should do."""
        position, quaternion = (obs[f"{self._cube}/{what}_in_world"] for what in ("position", "quaternion"))
        cube = self._base_from_world @ Pose(position, quaternion)
        x, y, z = obs[f"{self._arm}/tool_position_in_base"] - cube.position
        off_m = math.hypot(x, y)
        if off_m < 0.015 and z < 0.01:  # the cube is between the fingers
            held = obs[f"{self._arm}/gripper"][0] > HELD
            goal, gripper = np.array([*cube.position[:2], UP_M if held else cube.position[2]]), CLOSED
        else:
            goal, gripper = cube.position if off_m < 0.01 else cube.position + OVER_M, OPEN
        return Pose(goal, self._across(cube)), gripper

    def _across(self, cube: Pose) -> NDArray[np.float64]:
        """Return the turn of a tool that points down with its fingers on two sides of the cube."""
        x, y, _ = cube.rotation_matrix()[:, 0]
        yaw = math.remainder(math.atan2(y, x), math.pi / 2)
        return np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)])


if __name__ == "__main__":
    with closing(make_parallel_env("two_arm_multi_cube_lifting")) as env:
        experts = {arm.name: CubeLifter(arm) for arm in env.task.arms}
        for seed in range(3):
            observations, infos = env.reset(seed=seed)
            ticks = 0
            while env.agents:
                actions = {
                    arm: env.action_for(arm, *experts[arm].act(observations[arm])) for arm in env.agents
                }
                observations, _rewards, _terminations, _truncations, infos = env.step(actions)
                ticks += 1
            print(f"seed {seed}: {'success' if infos['arm0']['success'] else 'failure'} after {ticks} ticks")
