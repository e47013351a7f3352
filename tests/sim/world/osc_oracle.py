"""The controller once more, in plain numpy from MuJoCo's own Jacobian and mass matrix: slow and easy to check."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.arms.robot_file import Gains
from mart.protocol.tasks import Arm
from mart.sim.world import osc

Array = NDArray[np.float64]


def torques(model: mujoco.MjModel, data: mujoco.MjData, arm: str, block: Array, gains: Gains) -> Array:
    """Joint torques, shape (7,), for an arm whose goal is in `block`, its part of userdata; before clipping.

    Of a scene of Pandas alone. `data` must be complete up to qfrc_bias and qfrc_passive (mj_forward).
    """
    mobility = _mobility(model, data, arm, 7)
    inertia = np.linalg.inv(mobility + np.diag(_damping(mobility, gains))).astype(np.float64)
    return _torques(model, data, arm, block, gains=gains, inertia=inertia, count=7)


def torques_of_any_arm(
    model: mujoco.MjModel, data: mujoco.MjData, arm: Arm, block: Array, gains: Gains
) -> tuple[Array, bool]:
    """The same for an arm of any kind, and whether a direction was lost."""
    joints = arm.kind.joint_count
    mobility = _mobility(model, data, arm.name, joints)
    scale = np.sqrt(np.repeat([gains.regular_mobility_position, gains.regular_mobility_orientation], 3))
    values, vectors = np.linalg.eigh(mobility / np.outer(scale, scale))
    lost = np.maximum(1.0 - values, 0.0)
    damped = mobility + np.outer(scale, scale) * (vectors * lost**2 @ vectors.T)
    inertia = np.linalg.inv(damped)
    return _torques(model, data, arm.name, block, gains=gains, inertia=inertia, count=joints), bool(
        lost.any()
    )


def _mobility(model: mujoco.MjModel, data: mujoco.MjData, arm: str, joints: int) -> Array:
    first = int(model.joint(f"{arm}/joint1").dofadr[0])
    dofs = slice(first, first + joints)
    jacobian, mass = tool_jacobian(model, data, arm)[:, dofs], mass_matrix(model, data)[dofs, dofs]
    mobility: Array = jacobian @ np.linalg.inv(mass) @ jacobian.T
    return mobility


def _torques(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    arm: str,
    block: Array,
    *,
    gains: Gains,
    inertia: Array,
    count: int,
) -> Array:
    joint = model.joint(f"{arm}/joint1")
    dofs = slice(int(joint.dofadr[0]), int(joint.dofadr[0]) + count)
    joints = data.qpos[int(joint.qposadr[0]) :][:count]
    speeds = data.qvel[dofs]
    jacobian, mass = tool_jacobian(model, data, arm)[:, dofs], mass_matrix(model, data)[dofs, dofs]
    kp = np.repeat([gains.kp_position, gains.kp_orientation], 3)
    posture_kp = gains.kp_posture
    pull = posture_kp * (block[osc.POSTURE][:count] - joints) - 2 * np.sqrt(posture_kp) * speeds
    wanted = kp * pose_error(data, model.site(f"{arm}/tool").id, block, gains) - 2 * np.sqrt(kp) * (
        jacobian @ speeds
    )
    force = inertia @ (wanted - jacobian @ pull)
    return jacobian.T @ force + mass @ pull + data.qfrc_bias[dofs] - data.qfrc_passive[dofs]


def tool_jacobian(model: mujoco.MjModel, data: mujoco.MjData, arm: str) -> Array:
    """Translation, then rotation; shape (6, nv)."""
    jacobian = np.zeros((6, model.nv))
    mujoco.mj_jacSite(model, data, jacobian[:3], jacobian[3:], model.site(f"{arm}/tool").id)
    return jacobian


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def pose_error(data: mujoco.MjData, site: int, block: Array, gains: Gains) -> Array:
    turn = block[osc.GOAL_ROTATION].reshape(3, 3) @ data.site_xmat[site].reshape(3, 3).T
    quaternion, rotation = np.zeros(4), np.zeros(3)
    mujoco.mju_mat2Quat(quaternion, turn.flatten())
    mujoco.mju_quat2Vel(rotation, quaternion, 1.0)
    shift = block[osc.GOAL_POSITION] - data.site_xpos[site]
    return np.concatenate(
        [_within(shift, gains.max_position_error_m), _within(rotation, gains.max_orientation_error_rad)]
    )


def pivots(mobility: Array) -> Array:
    """What is left of each direction's mobility once those before it are kept; rotation first. Shape (6,)."""
    order = [3, 4, 5, 0, 1, 2]
    return np.diag(np.linalg.cholesky(mobility[np.ix_(order, order)])) ** 2


def _damping(mobility: Array, gains: Gains) -> Array:
    regular = np.repeat([gains.regular_mobility_position, gains.regular_mobility_orientation], 3)
    lost = max(0.0, float(np.max(1 - pivots(mobility) / np.roll(regular, 3))))
    return lost**2 * regular


def _within(vector: Array, length: float) -> Array:
    return vector / max(1.0, float(np.linalg.norm(vector)) / length)
