"""Actions and targets say the same thing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.operators import target_from_action
from mart.protocol.tasks import Limits
from tests.operators.rooms import POSE

_UNIT = st.floats(-1.0, 1.0)


@given(action=st.lists(_UNIT, min_size=7, max_size=7))
def test_a_target_is_the_measured_pose_and_a_step_within_the_limits(action: list[float]) -> None:
    limits = Limits()
    pose, gripper = target_from_action(POSE, action, limits)
    assert pose.position - POSE.position == pytest.approx(limits.step_m * np.array(action[:3]))
    turned_rad = 2 * np.arccos(min(1.0, abs(float(pose.quaternion_wxyz[0]))))
    assert turned_rad == pytest.approx(limits.step_rad * np.linalg.norm(action[3:6]), abs=1e-6)
    assert gripper == pytest.approx((action[6] + 1.0) / 2.0)
