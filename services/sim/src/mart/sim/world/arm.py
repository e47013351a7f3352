"""One arm's part of a world's state, measured in its own frames."""

from __future__ import annotations

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.sim.world.data import Array, Data, apply
from mart.sim.world.gripper import STROKE_M


class MeasuredArm:
    """Views into the data of a world or a batch; they follow it."""

    def __init__(self, model: mujoco.MjModel, data: Data, name: str) -> None:
        base, tool = model.body(f"{name}/base").id, model.site(f"{name}/tool").id
        hand = int(model.site_bodyid[tool])
        joints = int(model.joint(f"{name}/joint1").qposadr[0])
        fingers = [int(model.joint(f"{name}/{side}_finger").qposadr[0]) for side in ("left", "right")]
        turn_world_to_base = np.empty(4)
        mujoco.mju_negQuat(turn_world_to_base, model.body_quat[base])
        self._rotation_world_to_base = _matrix(turn_world_to_base)
        self._position_base_in_world = model.body_pos[base].copy()
        self._hand_to_tool = _between(turn_world_to_base, model.site_quat[tool])
        self._tool_position = data.site_xpos[..., tool, :]
        self._hand_quaternion = data.xquat[..., hand, :]
        self._joints = data.qpos[..., joints : joints + 7]
        self._fingers = data.qpos[..., fingers[0] : fingers[1] + 1]

    def tool_pose_in_base(self) -> Pose:
        """Of a single world."""
        return Pose(*self.tool_in_base())

    def tool_in_base(self) -> tuple[Array, Array]:
        """Position, shape (..., 3); quaternion wxyz, shape (..., 4), w >= 0."""
        position = apply(self._rotation_world_to_base, self._tool_position - self._position_base_in_world)
        quaternion = apply(self._hand_to_tool, self._hand_quaternion)
        return position, quaternion * np.copysign(1.0, quaternion[..., :1])

    def gripper(self) -> Array:
        """0 open … 1 closed, shape (...)."""
        opening = (self._fingers[..., 0] + self._fingers[..., 1]) / (2 * STROKE_M)
        return np.minimum(np.maximum(1.0 - opening, 0.0), 1.0)

    def joint_positions(self) -> Array:
        """Shape (..., 7), radians; a view."""
        return self._joints

    def place(self, joint_positions: Array) -> None:
        """At rest at these joint positions, shape (7,), gripper open."""
        self._joints[:] = joint_positions
        self._fingers[:] = STROKE_M


def _matrix(quaternion_wxyz: Array) -> Array:
    """The rotation matrix of a quaternion, shape (3, 3)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion_wxyz)
    return matrix.reshape(3, 3)


def _between(left_wxyz: Array, right_wxyz: Array) -> Array:
    """The matrix, shape (4, 4), that takes a quaternion q to left * q * right."""
    columns = []
    for unit in np.eye(4):
        product = np.empty(4)
        mujoco.mju_mulQuat(product, left_wxyz, unit)
        mujoco.mju_mulQuat(product, product.copy(), right_wxyz)
        columns.append(product)
    return np.column_stack(columns)
