"""Carrying poses: there and back is nowhere, and nothing is led faster than least jerk allows."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mart.protocol.pose import quaternion_multiply
from mart.recorder.multiply.transport import (
    angle_between,
    between,
    carried,
    folded,
    min_jerk,
    yaw_of,
    yaw_quaternion,
)

places = arrays(np.float64, 3, elements=st.floats(-2.0, 2.0))
turns = st.floats(-math.pi, math.pi)


@given(places, places, places, turns)
def test_carried_there_and_back_is_where_it_was(
    position: np.ndarray, origin: np.ndarray, other: np.ndarray, yaw_rad: float
) -> None:
    there = carried(position, origin, other, yaw_rad)
    assert np.allclose(carried(there, other, origin, -yaw_rad), position, atol=1e-9)


@given(places, places)
def test_carried_to_where_it_is_stays(position: np.ndarray, origin: np.ndarray) -> None:
    assert np.allclose(carried(position, origin, origin, 0.0), position, atol=1e-12)


@given(turns)
def test_a_turn_about_the_vertical_is_read_as_made(yaw_rad: float) -> None:
    assert math.isclose(math.cos(yaw_of(yaw_quaternion(yaw_rad)) - yaw_rad), 1.0, abs_tol=1e-12)


def test_the_turn_of_a_thing_whose_x_axis_stands_upright_is_read_by_its_y_axis() -> None:
    upright = np.array([math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0])
    turned = quaternion_multiply(yaw_quaternion(0.4), upright)
    assert math.isclose(yaw_of(turned) - yaw_of(upright), 0.4, abs_tol=1e-9)


@given(turns, st.sampled_from([1, 2, 4]))
def test_a_folded_turn_looks_the_same_and_is_the_smallest(yaw_rad: float, order: int) -> None:
    small = folded(yaw_rad, order)
    assert abs(small) <= math.pi / order + 1e-9
    assert math.isclose(math.cos(order * (small - yaw_rad)), 1.0, abs_tol=1e-9)


@given(st.lists(st.floats(-0.5, 1.5), min_size=2, max_size=20))
def test_least_jerk_rises_from_nothing_to_all(shares: list[float]) -> None:
    found = [min_jerk(share) for share in sorted(shares)]
    assert found == sorted(found)
    assert min_jerk(0.0) == 0.0
    assert min_jerk(1.0) == 1.0


@given(turns, turns, st.floats(0.0, 1.0))
def test_between_two_turns_lies_its_share_of_the_way(a: float, b: float, share: float) -> None:
    first, second = yaw_quaternion(a), yaw_quaternion(b)
    found = between(first, second, share)
    assert math.isclose(angle_between(first, found), share * angle_between(first, second), abs_tol=1e-6)
