from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.protocol.arms import PANDA
from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose
from mart.sim.world import World, kinematics


def test_joints_put_the_tool_where_it_should_be() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    random = np.random.default_rng(0)
    base = world.task.arm("arm1").pose_base_in_world
    data = mujoco.MjData(world.model)
    for _ in range(30):
        goal = base @ Pose.exp(
            [*random.uniform((0.40, -0.2, 0.02), (0.65, 0.2, 0.4)), 0, 0, random.uniform(-0.7, 0.7)]
        )
        joints = kinematics.solve(world.model, "arm1", goal, PANDA.home_rad)
        first = int(world.model.joint("arm1/joint1").qposadr[0])
        data.qpos[first : first + 7] = joints
        mujoco.mj_kinematics(world.model, data)
        site = data.site("arm1/tool")
        assert Pose.from_matrix(site.xmat.reshape(3, 3), site.xpos).distance_to(goal) == pytest.approx(
            (0, 0), abs=1e-5
        )


def test_what_is_out_of_reach_is_refused() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    with pytest.raises(InvalidInput):
        kinematics.solve(world.model, "arm0", Pose.exp([3, 0, 0, 0, 0, 0]), PANDA.home_rad)
