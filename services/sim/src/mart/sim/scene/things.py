"""View things and tools in the data of a world or a batch, for scenes. Shapes (...) are as in `Scene`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm
from mart.sim.scene.data import Array, Data, into_frame
from mart.sim.scene.gripper import stroke_m


class Thing:
    """View a body with a free joint of its own name, or a mocap body, which nothing moves. The views follow it."""

    def __init__(self, data: Data, name: str) -> None:
        body = data.body(name)
        self.name = name
        self.position, self.quaternion = body.xpos, body.xquat  # in the world, shapes (..., 3) and (..., 4)
        self.rotation = body.xmat.reshape(*body.xmat.shape[:-1], 3, 3)
        self.uprightness = self.rotation[..., 2, 2]  # cosine of its tilt, shape (...)
        self._data = data

    def put_at(self, pose_in_world: Pose) -> None:
        """Put it at a pose; it is one with a free joint, of a single world. The views follow as they do in `put`."""
        self._data.joint(self.name).qpos[:] = *pose_in_world.position, *pose_in_world.quaternion_wxyz

    def put(self, position: Sequence[float], yaw_rad: float = 0.0) -> None:
        """Stand it upright at a position in the world; the views follow with the next forward kinematics.

        Of a single world only.
        """
        data = cast("mujoco.MjData", self._data)
        mocap = int(data.model.body(self.name).mocapid[0])
        turn = (np.cos(yaw_rad / 2), 0.0, 0.0, np.sin(yaw_rad / 2))
        if mocap < 0:
            data.joint(self.name).qpos[:] = (*position, *turn)
        else:
            data.mocap_pos[mocap], data.mocap_quat[mocap] = position, turn

    def frame(self, points_in_world: Array) -> Array:
        """Return the same points in its own frame, shape (..., 3)."""
        return into_frame(self.rotation, points_in_world - self.position)

    def observations(self) -> dict[str, Array]:
        """Return its position and quaternion (wxyz) in the world, under the catalogue's names."""
        return {
            f"{self.name}/position_in_world": self.position,
            f"{self.name}/quaternion_in_world": self.quaternion,
        }


class Tool:
    """View the tool of an arm with fingers, which the views follow."""

    def __init__(self, data: Data, arm: Arm) -> None:
        self.position = data.site(f"{arm.name}/tool").xpos  # in the world, shape (..., 3)
        self._finger = data.joint(f"{arm.name}/left_finger").qpos
        self._stroke_m = stroke_m(arm.kind.end_effector)
        self.open_m = 2 * self._stroke_m  # between open pads

    @property
    def width_m(self) -> Array:
        """Return the gap between the pads, 0 where they touch, shape (...)."""
        return 2 * np.minimum(np.maximum(self._finger[..., 0], 0.0), self._stroke_m)
