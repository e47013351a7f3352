"""Measure the arms' part of a world's state, in their own frames."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from mart.protocol.tasks import Arm
from mart.sim.scene.data import Array, ChosenRows, Data, into_frame
from mart.sim.scene.gripper import stroke_m


class MeasuredArms:
    """Measure several arms at once, each in its own frames: shapes are (..., arms, n).

    It holds views into the data of a world or a batch, which follow it.
    """

    def __init__(self, model: mujoco.MjModel, data: Data, arms: Sequence[Arm]) -> None:
        names = [arm.name for arm in arms]
        bases = [model.body(f"{name}/base").id for name in names]
        tools = [model.site(f"{name}/tool").id for name in names]
        hands = [int(model.site_bodyid[tool]) for tool in tools]
        turns = [_conjugate(model.body_quat[base]) for base in bases]
        self._axes = np.stack([_matrix(turn).T for turn in turns])  # of the bases, each a column
        self._positions_base_in_world = model.body_pos[bases].copy()
        self._hands_to_tools = np.stack(
            [_between(turn, model.site_quat[tool]).T for turn, tool in zip(turns, tools, strict=True)]
        )
        self._tool_positions = ChosenRows(data.site_xpos, tools)
        self._hand_quaternions = ChosenRows(data.xquat, hands)
        self._grip = [index for index, arm in enumerate(arms) if arm.kind.has_fingers]
        self._strokes_m = np.array([stroke_m(arms[index].kind.end_effector) for index in self._grip])
        fingers = [_finger(model, names[index]) for index in self._grip]
        self._fingers = [ChosenRows(data.qpos[..., None], [f + side for f in fingers]) for side in (0, 1)]
        self.joint_positions = []  # radians; views, one of each arm
        for arm in arms:
            start = int(model.joint(f"{arm.name}/joint1").qposadr[0])
            self.joint_positions.append(data.qpos[..., start : start + arm.kind.joint_count])

    def tools_in_base(self) -> tuple[Array, Array]:
        """Return positions, shape (..., arms, 3), and quaternions wxyz, shape (..., arms, 4), w >= 0."""
        positions = into_frame(self._axes, self._tool_positions.read() - self._positions_base_in_world)
        quaternions = into_frame(self._hands_to_tools, self._hand_quaternions.read())
        return positions, quaternions * np.copysign(1.0, quaternions[..., :1])

    def grippers(self) -> Array:
        """Return how far each is closed, 0 open … 1 closed, shape (..., arms); 0 of an arm without fingers."""
        left, right = (fingers.read()[..., 0] for fingers in self._fingers)
        closed = np.minimum(np.maximum(1.0 - (left + right) / (2 * self._strokes_m), 0.0), 1.0)
        if len(self._grip) == len(self.joint_positions):
            return closed
        every = np.zeros((*closed.shape[:-1], len(self.joint_positions)))
        every[..., self._grip] = closed
        return every


class MeasuredArm:
    """Measure one arm of a single world."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, arm: Arm) -> None:
        self._alone = MeasuredArms(model, data, [arm])
        first = _finger(model, arm.name) if arm.kind.has_fingers else 0
        self._fingers = data.qpos[first : first + 2 * arm.kind.has_fingers]
        self._stroke_m = stroke_m(arm.kind.end_effector)

    def tool_in_base(self) -> tuple[Array, Array]:
        """Return position, shape (3,), and quaternion wxyz, shape (4,), w >= 0."""
        positions, quaternions = self._alone.tools_in_base()
        return positions[0], quaternions[0]

    def gripper(self) -> float:
        """Return how far it is closed, 0 open … 1 closed."""
        return float(self._alone.grippers()[0])

    def place(self, joint_positions: Array) -> None:
        """Set the arm to rest at these joint positions, radians, one for each joint; gripper open."""
        self._alone.joint_positions[0][:] = joint_positions
        self._fingers[:] = self._stroke_m


def _finger(model: mujoco.MjModel, arm: str) -> int:
    """Return where the positions of an arm's two fingers begin."""
    return int(model.joint(f"{arm}/left_finger").qposadr[0])


def _conjugate(quaternion_wxyz: Array) -> Array:
    conjugate = np.empty(4)
    mujoco.mju_negQuat(conjugate, quaternion_wxyz)
    return conjugate


def _matrix(quaternion_wxyz: Array) -> Array:
    """Return the rotation matrix of a quaternion, shape (3, 3)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion_wxyz)
    return matrix.reshape(3, 3)


def _between(left_wxyz: Array, right_wxyz: Array) -> Array:
    """Return the matrix, shape (4, 4), that takes a quaternion q to left * q * right."""
    columns = []
    for unit in np.eye(4):
        product = np.empty(4)
        mujoco.mju_mulQuat(product, left_wxyz, unit)
        mujoco.mju_mulQuat(product, product.copy(), right_wxyz)
        columns.append(product)
    return np.column_stack(columns)
