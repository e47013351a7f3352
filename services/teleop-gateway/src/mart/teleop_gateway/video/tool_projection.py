"""Find where in a seat's picture the arms' tools are, for whoever writes names or draws something there. Pure.

A camera looks along -z of its frame, y up (MuJoCo's convention); pictures are four wide and three high.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from mart.protocol.messages import State
from mart.protocol.pose import Pose
from mart.protocol.tasks import Task
from mart.render import viewpoint_id
from mart.teleop_gateway.video.seat_renderer import camera_in_world

_ASPECT = 4 / 3
_NEAREST_M = 0.01  # what is nearer to the camera is in no picture
_TABLE_Z_M = 0.0  # in the world
_LEAST_LEVEL = 1e-3  # of a camera's right-hand side

# Thousandths of the picture's width and height from its upper left corner, by arm; of tools outside it, nothing.
ToolPlaces = Mapping[str, tuple[int, int]]


@dataclass(frozen=True)
class ToolView:
    """Hold what a page needs to draw something near a tool into the picture, seen from a level frame at the camera.

    That frame's x is the picture's right, y is up, z is level and towards whoever looks. tool_m: where the tool is.
    table_m: how high the table's top is, so below 0. camera_wxyz: the camera's axes. focal: the picture's heights that
    a metre takes at a metre's distance.
    """

    tool_m: tuple[float, float, float]
    table_m: float
    camera_wxyz: tuple[float, float, float, float]
    focal: float


class ToolProjection:
    """Project the tools of a task's arms into the picture of one camera that stands still."""

    def __init__(self, camera: Pose, fov_y_rad: float, bases_in_world: Mapping[str, Pose]) -> None:
        """Take where the camera and the arms' bases are in the world, and the picture's height as an angle."""
        self._focal = 0.5 / math.tan(0.5 * fov_y_rad)  # in heights of the picture
        world_in_camera = camera.inverse()
        self._bases = {arm: _rows(world_in_camera @ base) for arm, base in bases_in_world.items()}
        self._level = _level_at(camera)
        self._bases_in_world = dict(bases_in_world)
        self._camera_in_level = self._level.inverse() @ camera

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

    def view_of(self, arm: str, state: State) -> ToolView | None:
        """Return what it takes to draw near an arm's tool; None where this state or task has none of that name."""
        base = self._bases_in_world.get(arm)
        tool = next((one.tool_in_base for one in state.arms if one.arm == arm), None)
        if base is None or tool is None:
            return None
        point_in_world = base.transform_points((tool.x, tool.y, tool.z))
        x, y, z = self._level.inverse().transform_points(point_in_world).round(3).tolist()
        w, i, j, k = self._camera_in_level.quaternion_wxyz.round(4).tolist()
        table_m = _TABLE_Z_M - float(self._level.position[2])
        return ToolView((x, y, z), round(table_m, 3), (w, i, j, k), round(self._focal, 4))


def _level_at(camera: Pose) -> Pose:
    """Return the level frame at a camera: x to the picture's right, y up; of one that is on its side, its own frame."""
    axes = camera.rotation_matrix()
    right = axes[:, 0] * (1.0, 1.0, 0.0)
    length = float(np.linalg.norm(right))
    if length < _LEAST_LEVEL:
        return camera
    x, y, _ = (right / length).tolist()
    return Pose.from_matrix(np.array([[x, 0.0, y], [y, 0.0, -x], [0.0, 1.0, 0.0]]), camera.position)


def _rows(pose: Pose) -> list[list[float]]:
    """Return the upper three rows of a pose's homogeneous matrix."""
    rows: list[list[float]] = np.column_stack([pose.rotation_matrix(), pose.position]).tolist()
    return rows
