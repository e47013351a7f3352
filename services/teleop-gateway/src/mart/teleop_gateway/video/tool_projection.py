"""Find where in a seat's picture the arms' tools are, for whoever writes names there. Pure.

A camera looks along -z of its frame, y up (MuJoCo's convention); pictures are four wide and three high.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import mujoco
import numpy as np

from mart.protocol.messages import State
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task
from mart.render import viewpoint_id
from mart.teleop_gateway.video.seat_renderer import camera_in_world

_ASPECT = 4 / 3
_NEAREST_M = 0.01  # what is nearer to the camera is in no picture

# Thousandths of the picture's width and height from its upper left corner, by arm; of tools outside it, nothing.
ToolPlaces = Mapping[str, tuple[int, int]]


class ToolProjection:
    """Project the tools of a task's arms into the picture of one camera that stands still."""

    def __init__(self, camera: Pose, fov_y_rad: float, bases_in_world: Mapping[str, Pose]) -> None:
        """Take where the camera and the arms' bases are in the world, and the picture's height as an angle."""
        self._focal = 0.5 / math.tan(0.5 * fov_y_rad)  # in heights of the picture
        world_in_camera = camera.inverse()
        self._bases = {arm: _rows(world_in_camera @ base) for arm, base in bases_in_world.items()}

    @classmethod
    def of(cls, model: mujoco.MjModel, task: Task, arm: str) -> ToolProjection:
        """Return the projection into the picture of `arm`'s seat."""
        fov_y_rad = math.radians(float(model.cam_fovy[viewpoint_id(model, arm)]))
        bases = {one.name: one.pose_base_in_world for one in task.arms}
        return cls(camera_in_world(model, arm), fov_y_rad, bases)

    def places(self, state: State) -> ToolPlaces:
        """Return where the tools are that can be in the picture; something may stand before them."""
        places = dict[str, tuple[int, int]]()
        for arm in state.arms:
            tool = arm.tool_in_base
            rows = self._bases.get(arm.arm)
            if rows is None:
                continue
            x, y, z = (a * tool.x + b * tool.y + c * tool.z + d for a, b, c, d in rows)
            if z > -_NEAREST_M:
                continue
            right, down = 0.5 - self._focal * x / z / _ASPECT, 0.5 + self._focal * y / z
            if 0 <= right <= 1 and 0 <= down <= 1:
                places[arm.arm] = round(1000 * right), round(1000 * down)
        return places


def _rows(pose: Pose) -> list[list[float]]:
    """Return the upper three rows of a pose's homogeneous matrix."""
    rows: list[list[float]] = np.column_stack([pose.rotation_matrix(), pose.position]).tolist()
    return rows
