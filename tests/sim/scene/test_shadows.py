from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.sim.world import World


def test_whoever_sets_the_state_sees_spots_under_tools_and_things() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(0)
    for _ in range(5):
        world.step([[1, 0.5, 0, 0, 0, 0, -1]] * 2)
    viewer = mujoco.MjData(world.model)
    state = np.frombuffer(world.integration_state(), "<f8")
    mujoco.mj_setState(world.model, viewer, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    mujoco.mj_kinematics(world.model, viewer)
    for number in range(2):
        tool, cube = viewer.site(f"arm{number}/tool"), viewer.body(f"cube{number}")
        assert viewer.body(f"arm{number}/shadow").xpos[:2] == pytest.approx(tool.xpos[:2], abs=1e-9)
        assert viewer.body(f"cube{number}/shadow").xpos[:2] == pytest.approx(cube.xpos[:2], abs=1e-9)


def test_nothing_touches_a_shadow() -> None:
    model = World.build("two_arm_multi_cube_lifting").model
    shadows = [i for i in range(model.ngeom) if model.body(model.geom_bodyid[i]).name.endswith("/shadow")]
    assert len(shadows) == 4
    assert not model.geom_contype[shadows].any()
    assert not model.geom_conaffinity[shadows].any()
