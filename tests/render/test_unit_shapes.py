"""Shapes are closed, face outwards, and are cut as finely as MuJoCo cuts them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mart.render import unit_shapes
from mart.render.unit_shapes import Corners

SLICES, STACKS, QUADS = 24, 6, 4


def volume(shape: Corners) -> float:
    """The volume that triangles enclose, positive where they face outwards."""
    a, b, c = np.moveaxis(shape.positions.reshape(-1, 3, 3), 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    ("shape", "round_volume", "share"),
    [
        (unit_shapes.sphere(SLICES, STACKS), 4 / 3 * math.pi, 0.85),
        (unit_shapes.cylinder(SLICES, STACKS), 2 * math.pi, 0.98),
        (unit_shapes.box(QUADS), 8.0, 1.0),
        (unit_shapes.capsule(SLICES, STACKS, 0.1, 0.5), math.pi * 0.01 * (1 + 0.4 / 3), 0.9),
    ],
)
def test_a_shape_fills_its_round_one_from_within(shape: Corners, round_volume: float, share: float) -> None:
    assert share * round_volume * (1 - 1e-9) <= volume(shape) <= round_volume * (1 + 1e-9)


@pytest.mark.parametrize(
    "shape",
    [
        unit_shapes.sphere(SLICES, STACKS),
        unit_shapes.cylinder(SLICES, STACKS),
        unit_shapes.box(QUADS),
        unit_shapes.capsule(SLICES, STACKS, 0.1, 0.5),
        unit_shapes.plane(1.0, 0.5, 0.1),
    ],
)
def test_normals_are_of_unit_length_and_face_as_the_triangles_do(shape: Corners) -> None:
    np.testing.assert_allclose(np.linalg.norm(shape.normals, axis=1), 1.0)
    a, b, c = np.moveaxis(shape.positions.reshape(-1, 3, 3), 1, 0)
    flat = np.cross(b - a, c - a)
    is_seen = np.linalg.norm(flat, axis=1) > 1e-12  # the pole of a ball is a ring of no width
    towards = np.einsum("ij,ikj->ik", flat, shape.normals.reshape(-1, 3, 3))
    assert (towards[is_seen] > 0).all()


def test_a_plane_is_cut_like_mujocos_and_ends_at_its_edges() -> None:
    shape = unit_shapes.plane(1.0, 0.5, 0.3)
    assert sorted(set(shape.positions[:, 0].round(9))) == [-1.0, -0.6, 0.0, 0.6, 1.0]
    assert sorted(set(shape.positions[:, 1].round(9))) == [-0.5, 0.0, 0.5]
