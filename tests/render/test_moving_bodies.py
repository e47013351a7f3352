"""Poses of bodies are those of the state, small enough for one packet, and the drop shadows are lifted."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import task_names
from mart.render.moving_bodies import BodyPoses, moving_bodies
from mart.sim.world import World
from tests.render.conftest import state_of
from tests.render.scene_reading import read_poses

SHA256 = "0123456789abcdef" * 4
ONE_PACKET_BYTES = 1150  # of SCTP; a second one would be lost on its own
FAR = "<mujoco><worldbody><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>"


@pytest.mark.parametrize("task", task_names())
def test_bodies_are_where_the_state_has_them(task: str) -> None:
    world = World.build(task)
    world.reset(3)
    state = world.integration_state()
    message = BodyPoses(world.model, SHA256).message(state, 5)
    assert len(message) <= ONE_PACKET_BYTES
    poses = read_poses(message)
    assert (poses.scene, poses.tick) == (SHA256[:8], 5)
    mujoco.mj_kinematics(world.model, world.data)
    bodies = np.array(moving_bodies(world.model))
    named = np.array([world.model.body(body).name.endswith("/shadow") for body in bodies])
    np.testing.assert_allclose(poses.positions_m[~named], world.data.xpos[bodies[~named]], atol=1e-4)
    np.testing.assert_allclose(poses.positions_m[named, :2], world.data.xpos[bodies[named], :2], atol=1e-4)
    np.testing.assert_allclose(poses.quaternions, world.data.xquat[bodies], atol=1e-4)


def test_a_spot_lies_on_the_tray_that_hides_the_table() -> None:
    world = World.build("two_arm_pick_place_handover")
    world.reset(3)
    poses = read_poses(BodyPoses(world.model, SHA256).message(world.integration_state(), 1))
    mujoco.mj_kinematics(world.model, world.data)
    lifts_m = poses.positions_m[:, 2] - world.data.xpos[list(moving_bodies(world.model)), 2]
    assert lifts_m.max() > 0.01


def test_a_body_far_away_is_still_told() -> None:
    model = mujoco.MjModel.from_xml_string(FAR)
    data = mujoco.MjData(model)
    data.qpos[:3] = (500.0, -3.0, 2.0)
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    poses = read_poses(BodyPoses(model, SHA256).message(state.tobytes(), 2**40))
    np.testing.assert_allclose(poses.positions_m, [[500.0, -3.0, 2.0]], atol=0.02)
    assert poses.tick == 2**40


def test_what_is_fixed_to_the_world_is_not_told(model: mujoco.MjModel) -> None:
    assert len(moving_bodies(model)) == 1
    poses = read_poses(BodyPoses(model, SHA256).message(state_of(model, 0.5), 1))
    np.testing.assert_allclose(poses.positions_m, [[0.8, 0.0, -0.4]], atol=1e-4)


@pytest.mark.parametrize("state", [b"", b"\0" * 8, b"\0" * 100_000])
def test_a_state_of_another_model_is_not_told(model: mujoco.MjModel, state: bytes) -> None:
    with pytest.raises(InvalidInput):
        BodyPoses(model, SHA256).message(state, 1)
