"""Draw the table: a calm surface, each arm's side in its colour and with its symbol, shade at the bases."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mart.protocol.tasks import Arm, Task
from mart.sim.scene.palette import rgba
from mart.sim.scene.symbols import outline

Image = NDArray[np.float64]

_PIXELS = 512
_SURFACE = rgba("#E7E2D8")[:3]
_SYMBOL_IN_BASE_M, _SYMBOL_RADIUS_M = 0.235, 0.038


def picture(task: Task, half_x_m: float, half_y_m: float) -> NDArray[np.uint8]:
    """Draw sRGB, shape (rows, columns, 3); the first row is the edge y = +half_y_m, the first column x = -half_x_m."""
    x, y = np.meshgrid(np.linspace(-half_x_m, half_x_m, _PIXELS), np.linspace(half_y_m, -half_y_m, _PIXELS))
    image = np.broadcast_to(_SURFACE, (_PIXELS, _PIXELS, 3)).copy()
    for arm in task.arms:
        _paint_side(image, arm, *_in_base(arm, x, y))
    _paint_frame(image, np.minimum(half_x_m - np.abs(x), half_y_m - np.abs(y)))
    return (np.clip(image, 0.0, 1.0) * 255).round().astype(np.uint8)


def _in_base(arm: Arm, x: Image, y: Image) -> tuple[Image, Image]:
    points = np.stack([x, y, np.zeros_like(x)], axis=-1)
    seen = arm.pose_base_in_world.inverse().transform_points(points)
    return seen[..., 0], seen[..., 1]


def _paint_side(image: Image, arm: Arm, x: Image, y: Image) -> None:
    color = rgba(arm.color)[:3]
    radius = np.hypot(x, y)
    _blend(image, color, 0.30 * np.exp(-((radius / 0.30) ** 2)))
    _blend(image, np.zeros(3), 0.35 * np.exp(-((radius / 0.15) ** 4)))
    facing = np.array([[0, 1], [-1, 0]])  # upright for someone who faces the arm
    corners = outline(arm.symbol, _SYMBOL_RADIUS_M) @ facing
    corners[:, 0] += _SYMBOL_IN_BASE_M
    _blend(image, color, _inside(corners, x, y))


def _paint_frame(image: Image, from_edge_m: Image) -> None:
    _blend(image, np.zeros(3), 0.10 * _smooth(0.003 - np.abs(from_edge_m - 0.018), 0.002))


def _inside(corners: Image, x: Image, y: Image) -> Image:
    """Return 1 inside a convex counter-clockwise polygon, 0 outside, soft over one pixel."""
    distance = np.full_like(x, np.inf)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        across = ((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) / np.hypot(x1 - x0, y1 - y0)
        distance = np.minimum(distance, across)
    return _smooth(distance, 0.0025)


def _smooth(distance: Image, width: float) -> Image:
    return np.clip(0.5 + distance / width, 0.0, 1.0)


def _blend(image: Image, color: NDArray[np.float64], share: Image) -> None:
    image += share[..., None] * (color - image)
