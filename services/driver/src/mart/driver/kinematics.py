"""Compute one arm's kinematics by a room's compiled model: joints to tool, and tool to joints in small steps."""

from __future__ import annotations

import mujoco
import numpy as np

from mart.driver.interface import Array
from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_log, quaternion_multiply

_DAMPING = 0.02  # near a singularity a centimetre then costs no whip; far from one it costs 1 % of a step
_ITERATIONS = 4
_POSTURE_GAIN = 0.02  # of what the posture asks for, a servo period
_TOLERANCE = 1e-5  # metres and radians


class ArmKinematics:
    """Hold the arm `arm` of a compiled model: its joints are all `{arm}/joint*`, its tool is the site `{arm}/tool`.

    Raises InvalidInput where the model has no such arm. Differential inverse kinematics by damped least squares
    (Wampler, 1986; Nakamura and Hanafusa, 1986), from the present joints: it never leaves their branch.
    """

    def __init__(self, model: mujoco.MjModel, arm: str) -> None:
        joints = [model.joint(i) for i in range(model.njnt) if model.joint(i).name.startswith(f"{arm}/joint")]
        site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"{arm}/tool")
        base = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, f"{arm}/base")
        if not joints or site < 0 or base < 0:
            raise InvalidInput(
                f"The model has no arm {arm!r}: joints {arm}/joint…, the site {arm}/tool and the body {arm}/base are "
                "needed."
            )
        self._model, self._data = model, mujoco.MjData(model)
        self._qpos = np.array([int(joint.qposadr[0]) for joint in joints])
        self._dof = np.array([int(joint.dofadr[0]) for joint in joints])
        self._site = site
        self.lowest, self.highest = np.array([joint.range for joint in joints]).T.copy()
        base_in_world = Pose(model.body_pos[base], model.body_quat[base])
        self._world_in_base = base_in_world.inverse()
        self._base_in_world = base_in_world
        self._jacobian = np.zeros((6, model.nv))

    @property
    def joint_count(self) -> int:
        """How many joints the arm has, without its gripper."""
        return len(self._qpos)

    def tool_in_base(self, joint_positions: Array) -> Pose:
        """Return the tool's pose in the arm's base frame at these joint positions, shape (joint_count,), radians."""
        self._place(joint_positions)
        in_world = Pose.from_matrix(
            self._data.site_xmat[self._site].reshape(3, 3), self._data.site_xpos[self._site]
        )
        return self._world_in_base @ in_world

    def towards(self, joint_positions: Array, tool_in_base: Pose, posture: Array) -> Array:
        """Return joint positions near the given ones that bring the tool to a pose nearby, as far as limits allow.

        posture: joint positions that are preferred where the pose leaves a choice. Shapes (joint_count,), radians.
        """
        joints = np.clip(joint_positions, self.lowest, self.highest)
        wanted = self._base_in_world @ tool_in_base
        for iteration in range(_ITERATIONS):
            self._place(joints)
            error = self._error(wanted)
            settled = float(np.abs(error).max()) < _TOLERANCE
            if settled and iteration:
                break
            jacobian = self._tool_jacobian()
            inverse = jacobian.T @ np.linalg.inv(jacobian @ jacobian.T + _DAMPING**2 * np.eye(6))
            step = inverse @ error
            if iteration == 0:
                pull = _POSTURE_GAIN * (posture - joints)
                step = step + pull - inverse @ (jacobian @ pull)
            joints = np.clip(joints + step, self.lowest, self.highest)
        return joints

    def _place(self, joint_positions: Array) -> None:
        self._data.qpos[self._qpos] = joint_positions
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)

    def _tool_jacobian(self) -> Array:
        mujoco.mj_jacSite(self._model, self._data, self._jacobian[:3], self._jacobian[3:], self._site)
        return self._jacobian[:, self._dof]

    def _error(self, wanted_in_world: Pose) -> Array:
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, self._data.site_xmat[self._site])
        turn = quaternion_multiply(wanted_in_world.quaternion_wxyz, quaternion_conjugate(quaternion))
        shift = wanted_in_world.position - self._data.site_xpos[self._site]
        return np.concatenate([shift, quaternion_log(turn)])
