"""A tool's motion is that of the simulated time, and a tool that was let go is held where it rests."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.pose import Pose, quaternion_exp
from mart.teleop_gateway.input.tool_motion import STOPPING_S, Stopping, ToolMotion
from tests.teleop_gateway.input.strategies import poses

HOME = Pose(np.array([0.5, 0.0, 0.3]), np.array([0.0, 1.0, 0.0, 0.0]))
steps_s = st.floats(0.01, 0.2)


def moved(pose: Pose, metres: float, radians: float = 0.0) -> Pose:
    turn = Pose(np.zeros(3), quaternion_exp(np.array([0.0, 0.0, radians])))
    return Pose(pose.position + np.array([0.0, metres, 0.0]), (turn @ pose).quaternion_wxyz)


@given(poses, steps_s)
def test_a_tool_that_stays_rests(pose: Pose, step_s: float) -> None:
    motion = ToolMotion(pose).after(pose, step_s)
    assert motion.rests
    metres, radians = motion.stopping_pose().distance_to(pose)
    assert metres < 1e-9
    assert radians < 1e-6


@given(steps_s, st.floats(-1.0, 1.0), st.floats(-3.0, 3.0))
def test_the_stopping_distance_is_a_twentieth_of_a_second_of_the_motion(
    step_s: float, m_per_s: float, rad_per_s: float
) -> None:
    now = moved(HOME, m_per_s * step_s, rad_per_s * step_s)
    metres, radians = ToolMotion(HOME).after(now, step_s).stopping_pose().distance_to(now)
    assert metres == pytest.approx(STOPPING_S * abs(m_per_s), abs=1e-9)
    assert radians == pytest.approx(STOPPING_S * abs(rad_per_s), abs=1e-6)


def test_nothing_is_known_of_a_motion_across_a_gap_or_a_reset() -> None:
    fast = ToolMotion(HOME, 1.0).after(moved(HOME, 0.05), 1.05)
    assert not fast.rests
    assert fast.after(moved(HOME, 0.4), 1.05) is fast  # the same state once more
    assert fast.after(moved(HOME, 0.4), 2.0).rests
    assert fast.after(moved(HOME, 0.4), 0.0).rests


def test_a_stopped_tool_that_sinks_is_not_followed() -> None:
    motion = ToolMotion(HOME, 0.0)
    stopping = Stopping(motion)
    for tick in range(1, 60):
        motion = motion.after(moved(HOME, -1e-4 * tick), 0.05 * tick)
        stopping.see(motion)
    assert stopping.target_tool_in_base.distance_to(HOME)[0] < 1e-3
