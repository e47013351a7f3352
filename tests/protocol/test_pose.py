"""SE(3) by its axioms: whatever satisfies these is the group, whatever the formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose, quaternion_from_matrix

coordinates = st.floats(-10.0, 10.0)
components = st.floats(-1.0, 1.0)


@st.composite
def poses(draw: st.DrawFn) -> Pose:
    quaternion = np.array([draw(components) for _ in range(4)])
    norm = np.linalg.norm(quaternion)
    quaternion = quaternion / norm if norm > 1e-3 else np.array([1.0, 0, 0, 0])
    return Pose(np.array([draw(coordinates) for _ in range(3)]), quaternion)


@st.composite
def twists(draw: st.DrawFn, largest_angle_rad: float = math.pi - 1e-3) -> np.ndarray:
    v = np.array([draw(coordinates) for _ in range(3)])
    omega = np.array([draw(components) for _ in range(3)])
    norm = np.linalg.norm(omega)
    angle = draw(st.floats(0.0, largest_angle_rad))
    return np.concatenate([v, omega / norm * angle if norm > 1e-6 else np.zeros(3)])


def assert_same(a: Pose, b: Pose, tolerance: float = 1e-9) -> None:
    metres, radians = a.distance_to(b)
    assert metres < tolerance * 100
    assert radians < tolerance * 100


@given(poses(), poses(), poses())
def test_composition_is_associative(a: Pose, b: Pose, c: Pose) -> None:
    assert_same((a @ b) @ c, a @ (b @ c))


@given(poses())
def test_identity_and_inverse(a: Pose) -> None:
    assert_same(a @ Pose.identity(), a)
    assert_same(Pose.identity() @ a, a)
    assert_same(a @ a.inverse(), Pose.identity())
    assert_same(a.inverse().inverse(), a)


@given(poses(), poses())
def test_inverse_of_a_product_is_the_product_of_inverses_reversed(a: Pose, b: Pose) -> None:
    assert_same((a @ b).inverse(), b.inverse() @ a.inverse())


@given(twists())
def test_log_undoes_exp(twist: np.ndarray) -> None:
    np.testing.assert_allclose(Pose.exp(twist).log(), twist, atol=1e-6)


@given(poses())
def test_exp_undoes_log(a: Pose) -> None:
    assert_same(Pose.exp(a.log()), a, tolerance=1e-7)


@given(twists(1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_exp_adds_along_one_twist(twist: np.ndarray, s: float, t: float) -> None:
    assert_same(Pose.exp(s * twist) @ Pose.exp(t * twist), Pose.exp((s + t) * twist), tolerance=1e-7)


@given(poses())
def test_the_rotation_matrix_is_a_rotation(a: Pose) -> None:
    rotation = a.rotation_matrix()
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert_same(Pose.from_matrix(rotation, a.position), a)


@given(poses(), poses())
def test_transforming_points_composes(a: Pose, b: Pose) -> None:
    points = np.array([[0.1, 0.2, 0.3], [-1.0, 0.0, 2.0]])
    np.testing.assert_allclose(
        (a @ b).transform_points(points), a.transform_points(b.transform_points(points)), atol=1e-9
    )


@given(poses())
def test_a_quaternion_is_canonical_and_of_unit_norm(a: Pose) -> None:
    assert a.quaternion_wxyz[0] >= 0
    assert np.linalg.norm(a.quaternion_wxyz) == pytest.approx(1.0, abs=1e-12)


def test_a_half_turn_about_each_axis_survives_the_matrix() -> None:
    for axis in range(3):
        rotation = -np.eye(3)
        rotation[axis, axis] = 1.0
        np.testing.assert_allclose(np.abs(quaternion_from_matrix(rotation)), np.eye(4)[axis + 1], atol=1e-12)


def test_a_pose_owns_its_numbers() -> None:
    position = np.zeros(3)
    pose = Pose(position, np.array([1.0, 0, 0, 0]))
    position[0] = 5.0
    assert pose.position[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        pose.position[0] = 1.0


@pytest.mark.parametrize(
    ("position", "quaternion", "word"),
    [
        ([0, 0], [1, 0, 0, 0], "shape"),
        ([0, 0, math.nan], [1, 0, 0, 0], "finite"),
        ([0, 0, 0], [math.inf, 0, 0, 0], "finite"),
        ([0, 0, 0], [1.2, 0, 0, 0], "norm"),
        ([0, 0, 0], [0, 0, 0, 0], "norm"),
    ],
)
def test_bad_numbers_are_refused_with_a_reason(
    position: list[float], quaternion: list[float], word: str
) -> None:
    with pytest.raises(InvalidInput, match=word):
        Pose(np.array(position), np.array(quaternion))
