from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.driver.kinematics import ArmKinematics
from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose
from tests.driver.led_arm import HOME_RAD, six_joint_model

_KINEMATICS = ArmKinematics(six_joint_model(), "arm0")


def test_it_knows_its_own_joints_among_others() -> None:
    assert _KINEMATICS.joint_count == 6
    assert _KINEMATICS.lowest == pytest.approx([-3.1] * 6)


def test_the_tool_is_seen_from_the_arm_s_base_wherever_that_stands() -> None:
    straight = _KINEMATICS.tool_in_base(np.zeros(6))
    assert straight.position == pytest.approx([0.425 + 0.392 + 0.0997 + 0.12, 0.134, 0.163], abs=1e-9)
    assert straight.quaternion_wxyz == pytest.approx([0.7071068, 0, -0.7071068, 0], abs=1e-6)


def test_a_model_without_the_arm_is_refused() -> None:
    with pytest.raises(InvalidInput):
        ArmKinematics(six_joint_model(), "arm1")


@given(
    shift=st.tuples(*[st.floats(-0.02, 0.02)] * 3),
    turn=st.tuples(*[st.floats(-0.1, 0.1)] * 3),
    joints=st.tuples(*[st.floats(-0.3, 0.3)] * 6),
)
def test_a_pose_nearby_is_reached_within_a_few_periods_on_the_same_branch(
    shift: tuple[float, ...], turn: tuple[float, ...], joints: tuple[float, ...]
) -> None:
    begin = HOME_RAD + np.array(joints)
    tool = _KINEMATICS.tool_in_base(begin)
    turned = Pose(np.zeros(3), Pose.exp([0, 0, 0, *turn]).quaternion_wxyz) @ Pose(
        np.zeros(3), tool.quaternion_wxyz
    )
    wanted = Pose(tool.position + np.array(shift), turned.quaternion_wxyz)
    found = begin
    for _ in range(10):
        found = _KINEMATICS.towards(found, wanted, begin)
    assert _KINEMATICS.tool_in_base(found).distance_to(wanted) == pytest.approx((0, 0), abs=1e-3)
    assert np.abs(found - begin).max() < 0.8


@given(target=st.tuples(*[st.floats(-2.0, 2.0)] * 3), joints=st.tuples(*[st.floats(-3.1, 3.1)] * 6))
def test_joints_stay_within_their_ranges_whatever_is_asked_for(
    target: tuple[float, ...], joints: tuple[float, ...]
) -> None:
    begin = np.array(joints)
    found = _KINEMATICS.towards(begin, Pose(np.array(target), np.array([1.0, 0, 0, 0])), HOME_RAD)
    assert np.isfinite(found).all()
    assert (found >= _KINEMATICS.lowest).all()
    assert (found <= _KINEMATICS.highest).all()
