from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.pose import Pose
from mart.protocol.tasks import Workspace

space = Workspace()
numbers = st.floats(-3, 3)
poses = st.builds(lambda *twist: Pose.exp(twist), *[numbers] * 6)


@st.composite
def allowed_poses(draw: st.DrawFn) -> Pose:
    azimuth, radius, z = draw(st.floats(-1.19, 1.19)), draw(st.floats(0.29, 0.57)), draw(st.floats(0.0, 0.64))
    yaw, tilt, level = (
        draw(st.floats(-1.89, 2.69)),
        draw(st.floats(0, 0.84)),
        draw(st.floats(-math.pi, math.pi)),
    )
    lean = Pose.exp([0, 0, 0, tilt * math.cos(level), tilt * math.sin(level), 0])
    turn = Pose.exp([0, 0, 0, 0, 0, azimuth + yaw])
    position = np.array([radius * math.cos(azimuth), radius * math.sin(azimuth), z])
    return Pose(position, (lean @ turn).quaternion_wxyz)


@given(poses)
def test_a_clamped_pose_is_inside(pose: Pose) -> None:
    x, y, z = space.clamp(pose).position
    assert math.hypot(x, y) >= space.radius_min_m - 1e-9
    assert math.dist((x, y, z), (0, 0, space.reach_center_z_m)) <= space.reach_m + 1e-9
    assert abs(math.atan2(y, x)) <= space.azimuth_max_rad + 1e-9
    assert space.z_min_m <= z <= space.z_max_m
    tilt = math.acos(min(1.0, space.clamp(pose).rotation_matrix()[2, 2]))
    assert tilt <= space.tilt_max_rad + 1e-6


@given(poses)
def test_clamping_twice_changes_nothing(pose: Pose) -> None:
    once = space.clamp(pose)
    assert space.clamp(once).distance_to(once) == pytest.approx((0, 0), abs=1e-6)


@given(allowed_poses())
def test_an_allowed_pose_stays_as_it_is(pose: Pose) -> None:
    assert space.clamp(pose).distance_to(pose) == pytest.approx((0, 0), abs=1e-7)


def test_on_the_base_axis_there_is_a_way_out() -> None:
    x, y, _ = space.clamp(Pose.exp([0, 0, 0.3, 0, 0, 0])).position
    assert math.hypot(x, y) == pytest.approx(space.radius_min_m)
