from __future__ import annotations

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.arms.robot_file import Gains
from mart.protocol.errors import Unavailable
from mart.protocol.pose import Pose
from mart.sim.world import World, osc
from tests.sim.world import osc_oracle

TASK = "two_arm_multi_cube_lifting"


@pytest.fixture(scope="module")
def world() -> World:
    world = World.build(TASK)
    world.model.actuator_ctrlrange[:] *= 1e6  # the oracle does not clip
    return world


def shaken(world: World, random: np.random.Generator, spread_rad: float) -> None:
    """Arms thrown about, moving, with goals somewhere near."""
    world.reset(int(random.integers(1000)))
    for arm in world.arms:
        joint = world.model.joint(f"{arm}/joint1")
        low, high = world.model.jnt_range[joint.id : joint.id + 7].T
        joints = world.data.qpos[int(joint.qposadr[0]) :][:7]
        joints[:] = np.clip(joints + random.normal(0, spread_rad, 7), low, high)
    world.data.qvel[:] = random.normal(0, 0.5, world.model.nv)
    blocks(world)[:, osc.COMMAND] = random.normal(0, 0.1, (len(world.arms), 7))
    blocks(world)[:, osc.MODE] = osc.NEW_DELTA


def blocks(world: World) -> NDArray[np.float64]:
    return world.data.userdata[: osc.BLOCK_SIZE * len(world.arms)].reshape(-1, osc.BLOCK_SIZE)


@pytest.mark.parametrize("spread_rad", [0.1, 1.0], ids=["at work", "near singularities"])
def test_c_and_numpy_agree(world: World, spread_rad: float) -> None:
    random = np.random.default_rng(0)
    for _ in range(100):
        shaken(world, random, spread_rad)
        mujoco.mj_forward(world.model, world.data)
        for arm, block in zip(world.arms, blocks(world), strict=True):
            wanted = osc_oracle.torques(world.model, world.data, arm, block, Gains())
            first = world.model.actuator(f"{arm}/torque1").id
            got = world.data.ctrl[first : first + 7]
            assert np.abs(got - wanted).max() <= 1e-9 * np.abs(wanted).max()


def test_a_new_goal_is_the_measured_pose_moved_along_the_base_axes(world: World) -> None:
    world.reset(1)
    delta = np.array([0.02, -0.01, 0.03, 0.1, -0.2, 0.3])
    before = world.tool_pose_in_base("arm1")
    blocks(world)[1, osc.COMMAND] = (*delta, 0.04)
    blocks(world)[1, osc.MODE] = osc.NEW_DELTA
    mujoco.mj_forward(world.model, world.data)
    goal_in_world = Pose.from_matrix(
        blocks(world)[1, osc.GOAL_ROTATION].reshape(3, 3), blocks(world)[1, osc.GOAL_POSITION]
    )
    goal = world.task.arm("arm1").pose_base_in_world.inverse() @ goal_in_world
    turn = Pose.exp([0, 0, 0, *delta[3:]]) @ Pose(np.zeros(3), before.quaternion_wxyz)
    assert goal.distance_to(Pose(before.position + delta[:3], turn.quaternion_wxyz)) == pytest.approx(
        (0, 0), abs=1e-7
    )
    assert blocks(world)[1, osc.MODE] == osc.HOLD_GOAL


def test_the_work_space_is_free_of_extra_damping(world: World) -> None:
    gains = Gains()
    for seed in range(30):
        world.reset(seed)
        for arm in world.arms:
            joint = world.model.joint(f"{arm}/joint1")
            dofs = slice(int(joint.dofadr[0]), int(joint.dofadr[0]) + 7)
            jacobian = osc_oracle.tool_jacobian(world.model, world.data, arm)[:, dofs]
            mass = osc_oracle.mass_matrix(world.model, world.data)[dofs, dofs]
            left = osc_oracle.pivots(jacobian @ np.linalg.inv(mass) @ jacobian.T)
            assert left[:3].min() > gains.regular_mobility_orientation
            assert left[3:].min() > gains.regular_mobility_position


def test_models_of_others_are_left_alone() -> None:
    osc.install()
    stranger = mujoco.MjModel.from_xml_string(
        "<mujoco><custom><numeric name='osc' data='1 2 3 4 5 6 7 8 9 10'/></custom><worldbody><body><joint name='j'/>"
        "<geom size='1'/></body></worldbody><actuator><motor joint='j'/></actuator></mujoco>"
    )
    data = mujoco.MjData(stranger)
    data.ctrl[0] = 0.5
    mujoco.mj_step(stranger, data, 10)
    assert data.ctrl[0] == 0.5


def test_limp_after_a_bare_mujoco_reset(world: World) -> None:
    world.reset(0)
    mujoco.mj_resetData(world.model, world.data)
    mujoco.mj_forward(world.model, world.data)
    assert not world.data.ctrl.any()


def test_another_mujoco_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mujoco, "mj_version", lambda: 4_000_001)
    with pytest.raises(
        Unavailable, match=r"compiled for MuJoCo 4000000, but 4000001 is installed: reinstall mart-sim"
    ):
        osc.install()


def test_a_missing_controller_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(osc, "find_spec", lambda name: None)
    with pytest.raises(Unavailable):
        osc.install()
