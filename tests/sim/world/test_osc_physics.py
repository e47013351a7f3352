"""The controller against physics: what it must do whatever its numbers are, with every kind of arm.

Goals are given to it directly.
"""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mart.protocol.arms import arm_kind_names
from mart.protocol.arms.robot_file import Gains
from mart.protocol.pose import Pose
from mart.sim.experts.hand_motion import difference
from mart.sim.world import World, osc
from tests.sim.world import osc_oracle

ARM = "arm0"
STEP = np.array([0.05, 0.05, 0.05, 0.2, 0.2, 0.2])  # metres, radians
GAINS = Gains()


# arm0 is looked at. Beside another kind a Panda is controlled as every arm is; two Pandas are as they ever were.
KINDS = [
    ("panda", "panda"),
    ("panda", "ur5e"),
    *((kind, "panda") for kind in arm_kind_names() if kind != "panda" and ":" not in kind),
]


@pytest.fixture(scope="module", params=KINDS, ids="-beside-".join)
def world(request: pytest.FixtureRequest) -> World:
    return World.build("two_arm_multi_cube_lifting", kinds=request.param)


@pytest.fixture(autouse=True)
def begin(world: World) -> None:
    world.reset(0)


def block(world: World) -> NDArray[np.float64]:
    return world.data.userdata[: osc.BLOCK_SIZE]


def aim(world: World, delta: NDArray[np.float64]) -> None:
    """One new goal for the arm, shape (6,) from where its tool is; kept until the next."""
    block(world)[osc.COMMAND][:6] = delta
    block(world)[osc.MODE] = osc.NEW_DELTA


def track(world: World, duration_s: float, every: int = 5) -> NDArray[np.float64]:
    """How far the tool is from where it is now, shape (times, 6), along the base axes."""
    start, way = world.tool_pose_in_base(ARM), []
    for _ in range(round(duration_s / (every * world.model.opt.timestep))):
        mujoco.mj_step(world.model, world.data, every)
        mujoco.mj_kinematics(world.model, world.data)
        way.append(np.concatenate(difference(world.tool_pose_in_base(ARM), start)))
    return np.array(way)


def dofs(world: World) -> slice:
    first = int(world.model.joint(f"{ARM}/joint1").dofadr[0])
    return slice(first, first + joints(world))


def joints(world: World) -> int:
    return world.task.arm(ARM).kind.joint_count


def mobility(world: World) -> NDArray[np.float64]:
    """J M⁻¹ Jᵀ of the tool, shape (6, 6): acceleration for a wrench; in the world's axes, as are arm0's."""
    mujoco.mj_forward(world.model, world.data)
    jacobian = osc_oracle.tool_jacobian(world.model, world.data, ARM)[:, dofs(world)]
    mass = osc_oracle.mass_matrix(world.model, world.data)[dofs(world), dofs(world)]
    return jacobian @ np.linalg.inv(mass) @ jacobian.T


def kinetic_energy(world: World) -> float:
    mass = osc_oracle.mass_matrix(world.model, world.data)[dofs(world), dofs(world)]
    speed = world.data.qvel[dofs(world)]
    return 0.5 * float(speed @ mass @ speed)


@pytest.mark.parametrize("axis", range(6), ids=["x", "y", "z", "about x", "about y", "about z"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_step_on_any_axis_neither_overshoots_nor_disturbs_the_others(
    world: World, axis: int, sign: int
) -> None:
    goal = sign * STEP * np.eye(6)[axis]
    aim(world, goal)
    covered = track(world, 1.5) / STEP
    along = sign * covered[:, axis]
    assert along.max() < 1.02
    assert along[-1] == pytest.approx(1.0, abs=0.005)
    rise_s = 0.01 * int(np.argmax(along > 0.9))
    assert 0.2 < rise_s < 0.45  # critically damped with kp 150: 0.32 s
    assert np.abs(np.delete(covered, axis, axis=1)).max() < 0.06


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 1, 1)])
def test_it_comes_back_from_a_goal_out_of_reach(world: World, direction: tuple[float, float, float]) -> None:
    start = world.tool_pose_in_base(ARM)
    aim(world, np.array([*direction, 0.0, 0.0, 0.0]) * 1.5)
    speeds = []
    for _ in range(100):
        track(world, 0.02)
        speeds.append(np.abs(world.data.qvel[dofs(world)]).max())
    assert max(speeds) < 10
    for _ in range(200):  # as a person would: again and again towards where it was
        aim(world, np.concatenate(difference(start, world.tool_pose_in_base(ARM))))
        track(world, 0.05)
    metres, radians = start.distance_to(world.tool_pose_in_base(ARM))
    assert metres < 0.002
    assert radians < 0.01


@pytest.mark.parametrize("axis", range(6))
def test_a_load_bends_it_as_far_as_its_stiffness_says(world: World, axis: int) -> None:
    """At rest, kp Λ e = F: the error is that of a spring of kp times the effective inertia."""
    wrench = np.array([3.0, 3.0, 3.0, 0.2, 0.2, 0.2]) * np.eye(6)[axis]  # newtons, newton metres
    predicted = mobility(world) @ wrench / GAINS.kp_position
    for _ in range(40):
        jacobian = osc_oracle.tool_jacobian(world.model, world.data, ARM)[:, dofs(world)]
        world.data.qfrc_applied[dofs(world)] = jacobian.T @ wrench
        track(world, 0.05)
    start = Pose(*goal_in_base(world))
    error = np.concatenate(difference(world.tool_pose_in_base(ARM), start))
    assert np.abs(error - predicted).max() < 0.05 * np.abs(predicted).max()


def goal_in_base(world: World) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    arm = world.task.arm(ARM).pose_base_in_world
    in_world = Pose.from_matrix(
        block(world)[osc.GOAL_ROTATION].reshape(3, 3), block(world)[osc.GOAL_POSITION]
    )
    goal = arm.inverse() @ in_world
    return goal.position, goal.quaternion_wxyz


def test_another_posture_moves_the_elbow_and_not_the_tool(world: World) -> None:
    before = world.data.qpos[dofs(world)].copy()
    block(world)[osc.POSTURE] += (0.4, 0.0, -0.4, 0.0, 0.3, 0.0, 0.0)
    moved = track(world, 3.0)
    elbow_rad = np.abs(world.data.qpos[dofs(world)] - before).max()
    assert elbow_rad > 0.1 if joints(world) == 7 else elbow_rad < 0.01  # six joints have no elbow to spare
    assert np.abs(moved[:, :3]).max() < 0.001
    assert np.abs(moved[:, 3:]).max() < 0.005


@given(seed=st.integers(0, 2**32 - 1))
def test_the_jacobian_is_the_derivative_of_the_pose(world: World, seed: int) -> None:
    random = np.random.default_rng(seed)
    positions = world.data.qpos[dofs(world)]
    low, high = world.model.jnt_range[world.model.joint(f"{ARM}/joint1").id :][: joints(world)].T
    middle = random.uniform(low, high)
    positions[:] = middle
    mujoco.mj_forward(world.model, world.data)
    jacobian = osc_oracle.tool_jacobian(world.model, world.data, ARM)[:, dofs(world)]
    step = 1e-6
    for joint in range(joints(world)):
        poses = []
        for side in (-1, 1):
            positions[:] = middle + side * step * np.eye(joints(world))[joint]
            mujoco.mj_kinematics(world.model, world.data)
            poses.append(world.tool_pose_in_base(ARM))
        shift, turn = difference(poses[1], poses[0])
        np.testing.assert_allclose(np.concatenate([shift, turn]) / (2 * step), jacobian[:, joint], atol=1e-6)


@pytest.mark.parametrize("axis", range(6))
def test_no_more_motion_comes_out_than_the_goal_put_in(world: World, axis: int) -> None:
    """A goal stores the energy of its spring, kp e·Λe / 2; damping takes all of it in the end."""
    goal = STEP * np.eye(6)[axis]
    stored_j = 0.5 * GAINS.kp_position * float(goal @ np.linalg.solve(mobility(world), goal))
    aim(world, goal)
    energies_j = []
    for _ in range(150):
        track(world, 0.01)
        energies_j.append(kinetic_energy(world))
    assert 0.02 * stored_j < max(energies_j) < 0.5 * stored_j
    assert energies_j[-1] < 1e-5 * stored_j


def test_a_blow_dies_away(world: World) -> None:
    world.data.qvel[dofs(world)] = (0.5, -0.5, 0.5, -0.5, 1.0, -1.0, 1.0)[: joints(world)]
    start_j = kinetic_energy(world)
    energies_j = []
    for _ in range(200):
        track(world, 0.01)
        energies_j.append(kinetic_energy(world))
    assert max(energies_j) < start_j
    assert energies_j[-1] < 1e-5 * start_j
