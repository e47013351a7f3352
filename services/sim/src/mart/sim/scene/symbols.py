"""Show the arms' symbols as flat tiles, so that colour is never the only sign of who is who."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

# Corners and the angle of the first one; equal areas look equally large.
_POLYGONS = {
    "circle": (32, 0.0),
    "square": (4, math.pi / 4),
    "triangle": (3, math.pi / 2),
    "diamond": (4, 0.0),
}
_THICKNESS_M = 0.0004
_WHITE = (0.98, 0.98, 0.98, 1.0)


def outline(symbol: str, radius_m: float) -> NDArray[np.float64]:
    """Return the corners, shape (n, 2), of a polygon with the area of a circle of this radius, counter-clockwise."""
    corners, first = _POLYGONS[symbol]
    angles = first + 2 * math.pi * np.arange(corners) / corners
    reach = radius_m * math.sqrt(2 * math.pi / (corners * math.sin(2 * math.pi / corners)))
    stretch = (0.8, 1.25) if symbol == "diamond" else (1.0, 1.0)
    return reach * np.column_stack([np.cos(angles), np.sin(angles)]) * stretch


def add_tile(
    spec: mujoco.MjSpec,
    body: mujoco.MjsBody,
    symbol: str,
    *,
    radius_m: float,
    position: tuple[float, float, float],
    normal: tuple[float, float, float],
) -> None:
    """Put a white tile on a surface of the body; `position` and `normal` in the body's frame."""
    mesh = f"symbol/{symbol}/{radius_m * 1000:g}mm"
    if spec.mesh(mesh) is None:
        flat = outline(symbol, radius_m)
        sides = [np.column_stack([flat, np.full(len(flat), z)]) for z in (-_THICKNESS_M, _THICKNESS_M)]
        spec.add_mesh(name=mesh, uservert=np.concatenate(sides).ravel())
    quaternion = np.zeros(4)
    mujoco.mju_quatZ2Vec(quaternion, np.array(normal, dtype=np.float64))
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=mesh,
        pos=position,
        quat=quaternion,
        rgba=_WHITE,
        mass=0,
        contype=0,
        conaffinity=0,
    )
