"""One arm's part of a world's state, measured in its own frames."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.world.gripper import STROKE_M


class MeasuredArm:
    """Views into mjData; they follow it."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, name: str) -> None:
        base, tool = model.body(f"{name}/base").id, model.site(f"{name}/tool").id
        joints = int(model.joint(f"{name}/joint1").qposadr[0])
        fingers = [int(model.joint(f"{name}/{side}_finger").qposadr[0]) for side in ("left", "right")]
        self._turn_world_to_base = np.empty(4)
        mujoco.mju_negQuat(self._turn_world_to_base, model.body_quat[base])
        self._position_base_in_world = model.body_pos[base].copy()
        self._tool_position, self._tool_rotation = data.site_xpos[tool], data.site_xmat[tool]
        self._joints = data.qpos[joints : joints + 7]
        self._fingers = data.qpos[fingers[0] : fingers[1] + 1]

    def tool_pose_in_base(self) -> Pose:
        return Pose(*self.tool_in_base())

    def tool_in_base(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The same as bare arrays, on every tick's path: position, shape (3,); quaternion wxyz, shape (4,), w >= 0."""
        position, in_world, quaternion = np.empty(3), np.empty(4), np.empty(4)
        mujoco.mju_rotVecQuat(
            position, self._tool_position - self._position_base_in_world, self._turn_world_to_base
        )
        mujoco.mju_mat2Quat(in_world, self._tool_rotation)
        mujoco.mju_mulQuat(quaternion, self._turn_world_to_base, in_world)
        return position, -quaternion if quaternion[0] < 0 else quaternion

    def gripper(self) -> float:
        """0 open … 1 closed."""
        left_m, right_m = self._fingers.tolist()
        return min(max(1.0 - (left_m + right_m) / (2 * STROKE_M), 0.0), 1.0)

    def joint_positions(self) -> NDArray[np.float64]:
        """Shape (7,), radians."""
        return self._joints.copy()

    def place(self, joint_positions: NDArray[np.float64]) -> None:
        """At rest at these joint positions, shape (7,), gripper open."""
        self._joints[:] = joint_positions
        self._fingers[:] = STROKE_M
