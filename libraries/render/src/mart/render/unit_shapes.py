"""Cut spheres, cylinders, boxes and planes into the very triangles that MuJoCo's renderer draws.

Light is computed at the corners, so other triangles would look different. Sources: `makeBuiltin` and `makePlane` of
MuJoCo's `render_context.c`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

_LONGEST_GRID = 200  # quads along a plane, mjMAXPLANEGRID
_SIDES = (  # of a box: its normal, and the two axes along which it is cut, right-handed
    ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
    ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((-1, 0, 0), (0, 0, 1), (0, 1, 0)),
    ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
)


@dataclass(frozen=True)
class Corners:
    """Hold triangles as their corners: positions and unit normals, float64, shape (3 n, 3), counter-clockwise."""

    positions: Numbers
    normals: Numbers


def sphere(slices: int, stacks: int) -> Corners:
    """Return a ball of radius 1."""
    elevations = np.linspace(-math.pi / 2, math.pi / 2, 2 * (stacks // 2) + 1)
    points = _rings(slices, elevations, np.zeros_like(elevations))
    return Corners(points, points)


def capsule(slices: int, stacks: int, radius_m: float, half_length_m: float) -> Corners:
    """Return a cylinder along z with half a ball at each end; `half_length_m` is the cylinder's."""
    quarter = np.linspace(0, math.pi / 2, stacks // 2 + 1)
    ball = np.concatenate((-quarter[::-1], quarter))
    heights = np.repeat([-half_length_m, half_length_m], len(quarter))
    normals = _rings(slices, ball, np.zeros_like(ball))
    positions = _rings(slices, ball, heights / radius_m) * radius_m
    return Corners(positions, normals)


def cylinder(slices: int, stacks: int) -> Corners:
    """Return a closed cylinder of radius 1 along z, from -1 to 1."""
    wall = _grid(slices, stacks)
    angles, heights = wall[:, 0] * 2 * math.pi, wall[:, 1] * 2 - 1
    round_ = np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), axis=1)
    walls = Corners(round_ + heights[:, np.newaxis] * (0, 0, 1), round_)
    return _joined([walls, _disk(slices, 1), _disk(slices, -1)])


def box(quads: int) -> Corners:
    """Return a box from -1 to 1 on every axis, each side cut into `quads` x `quads`."""
    across = _grid(quads, quads) * 2 - 1
    return _joined(
        [
            Corners(np.array(normal) + across @ np.array([first, second]), np.tile(normal, (len(across), 1)))
            for normal, first, second in np.array(_SIDES, dtype=np.float64)
        ]
    )


def plane(half_x_m: float, half_y_m: float, spacing_m: float) -> Corners:
    """Return a rectangle around the origin, facing z, cut where MuJoCo cuts it."""
    lines_x, lines_y = _lines(half_x_m, spacing_m), _lines(half_y_m, spacing_m)
    cells = _grid(len(lines_x) - 1, len(lines_y) - 1) * (len(lines_x) - 1, len(lines_y) - 1)
    at = np.rint(cells).astype(int)
    positions = np.stack((lines_x[at[:, 0]], lines_y[at[:, 1]], np.zeros(len(at))), axis=1)
    return Corners(positions, np.tile((0.0, 0.0, 1.0), (len(at), 1)))


def _lines(half_m: float, spacing_m: float) -> Numbers:
    """Return where a plane's grid has its lines along one axis."""
    spacing = max(spacing_m, half_m / (_LONGEST_GRID - 2))
    inner = math.floor(half_m / spacing)
    inner -= inner % 2
    ends = half_m - (half_m - inner * spacing)
    return np.concatenate(([-half_m], np.linspace(-ends, ends, inner + 1), [half_m]))


def _rings(slices: int, elevations: Numbers, lifts: Numbers) -> Numbers:
    """Return the corners between rings of a ball: each ring at its elevation, lifted along z."""
    grid = _grid(slices, len(elevations) - 1)
    at = np.rint(grid[:, 1] * (len(elevations) - 1)).astype(int)
    azimuths, elevation = grid[:, 0] * 2 * math.pi, elevations[at]
    flat = np.cos(elevation)
    return np.stack((np.cos(azimuths) * flat, np.sin(azimuths) * flat, np.sin(elevation) + lifts[at]), axis=1)


def _disk(slices: int, side: int) -> Corners:
    """Return an end of a cylinder. MuJoCo cuts it into rings too, which changes nothing: its normal is one."""
    angles = np.arange(slices + 1) * 2 * math.pi / slices
    rim = np.stack((np.cos(angles), np.sin(angles), np.full(slices + 1, side)), axis=1)
    centre = np.tile((0.0, 0.0, side), (slices, 1))
    first, second = (rim[:-1], rim[1:]) if side > 0 else (rim[1:], rim[:-1])
    positions = np.stack((centre, first, second), axis=1).reshape(-1, 3)
    return Corners(positions, np.tile((0.0, 0.0, side), (3 * slices, 1)))


def _grid(columns: int, rows: int) -> Numbers:
    """Return the corners of two triangles a cell, counter-clockwise, as shares of the width and height: (6 n, 2)."""
    cell = np.array([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)], dtype=np.float64)
    origin = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 1, 2)
    return ((origin + cell) / (columns, rows)).reshape(-1, 2)


def _joined(parts: list[Corners]) -> Corners:
    return Corners(
        np.concatenate([part.positions for part in parts]), np.concatenate([part.normals for part in parts])
    )
