"""Place arms at a reset: inverse kinematics by damped least squares (Wampler, 1986)."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose

_DAMPING = 1e-3
_ITERATIONS = 200
_TOLERANCE = 1e-6  # metres and radians
_LARGEST_STEP_RAD = 0.3


def solve(
    model: mujoco.MjModel, arm: str, pose_tool_in_world: Pose, start_rad: ArrayLike
) -> NDArray[np.float64]:
    """Return joint positions, radians, that put the arm's tool at the pose, near `start_rad`, of the same shape.

    Raises InvalidInput where the arm cannot reach it.
    """
    data = mujoco.MjData(model)
    site = model.site(f"{arm}/tool").id
    joint = model.joint(f"{arm}/joint1")
    qpos, dof = int(joint.qposadr[0]), int(joint.dofadr[0])
    joints = np.array(start_rad, dtype=np.float64)
    count = len(joints)
    low, high = model.jnt_range[joint.id : joint.id + count].T
    jacobian = np.zeros((6, model.nv))
    for _ in range(_ITERATIONS):
        data.qpos[qpos : qpos + count] = joints
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        error = _error(data, site, pose_tool_in_world)
        if np.abs(error).max() < _TOLERANCE:
            return joints
        mujoco.mj_jacSite(model, data, jacobian[:3], jacobian[3:], site)
        step = _damped_step(jacobian[:, dof : dof + count], error)
        joints = np.clip(joints + step, low, high)
    raise InvalidInput(
        f"{arm} cannot reach {pose_tool_in_world.position.round(3).tolist()} (world, metres): choose a nearer pose."
    )


def _error(data: mujoco.MjData, site: int, goal: Pose) -> NDArray[np.float64]:
    measured = Pose.from_matrix(data.site_xmat[site].reshape(3, 3), data.site_xpos[site])
    turn = Pose(np.zeros(3), goal.quaternion_wxyz) @ Pose(np.zeros(3), measured.quaternion_wxyz).inverse()
    return np.concatenate([goal.position - measured.position, turn.log()[3:]])


def _damped_step(jacobian: NDArray[np.float64], error: NDArray[np.float64]) -> NDArray[np.float64]:
    step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + _DAMPING * np.eye(6), error)
    largest = float(np.abs(step).max())
    return step * min(1.0, _LARGEST_STEP_RAD / largest) if largest > 0 else step
