"""A way is led as it was recorded, slower, from where it began; what is no way, or begins too far off, is refused."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.pose import Pose
from mart.recorder.replay.led_way import (
    APPROACH_M_S,
    APPROACH_RAD_S,
    LedWay,
    RecordedWay,
    StandingArm,
    require_near,
)
from tests.recorder.replay.ways import ARMS, BEGIN_M, DOWN, JOINTS_RAD, PERIOD_S, swung

_STEP_S = 0.2


def test_at_each_recorded_time_it_is_where_it_was_with_the_gripper_of_then() -> None:
    way = RecordedWay.of(swung(60), ARMS)
    assert way.duration_s == pytest.approx(60 * PERIOD_S)
    for tick in (0, 17, 59, 60):
        target = way.at(tick * PERIOD_S + 1e-9)["arm1"]
        away_m, away_rad = target.pose_tool_in_base.distance_to(way.arms["arm1"].poses[tick])
        assert (away_m, away_rad) == pytest.approx((0.0, 0.0), abs=1e-6)
        assert target.gripper == (1.0 if tick >= 30 else 0.0)


@settings(max_examples=25, deadline=None)
@given(
    shift_m=st.tuples(*[st.floats(-0.1, 0.1)] * 3),
    turn_rad=st.floats(0.0, 0.6),
    speed=st.floats(0.05, 0.5),
)
def test_it_leads_slowly_to_the_beginning_and_never_faster_than_a_share_of_the_recording(
    shift_m: tuple[float, float, float], turn_rad: float, speed: float
) -> None:
    recorded = RecordedWay.of(swung(20), ["arm0"])
    turned = Pose(np.zeros(3), np.array([np.cos(turn_rad / 2), 0, 0, np.sin(turn_rad / 2)]))
    stands = Pose(BEGIN_M + np.array(shift_m), (turned @ Pose(np.zeros(3), DOWN)).quaternion_wxyz)
    led = LedWay(recorded, {"arm0": stands}, speed)
    poses = [
        led.at(time_s)["arm0"].pose_tool_in_base
        for time_s in np.arange(0.0, led.duration_s + _STEP_S, _STEP_S)
    ]
    assert poses[0].distance_to(stands) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert poses[-1].distance_to(recorded.arms["arm0"].poses[-1]) == pytest.approx((0.0, 0.0), abs=1e-6)
    fastest_m_s = max(APPROACH_M_S, led.fastest_m_s("arm0"))
    for before, after in pairwise(poses):
        away_m, away_rad = after.distance_to(before)
        assert away_m <= fastest_m_s * _STEP_S + 1e-6
        assert away_rad <= APPROACH_RAD_S * _STEP_S + 1e-6


def test_an_arm_too_far_from_the_beginning_is_refused_with_what_is_allowed() -> None:
    way = RecordedWay.of(swung(), ["arm0"])
    far = StandingArm(Pose(BEGIN_M + np.array([0.3, 0.0, 0.0]), DOWN), JOINTS_RAD)
    with pytest.raises(Conflict, match=r"arm0 stands too far .* 0\.30 m .* 0\.25 m and 0\.8 rad are allowed"):
        require_near(way, {"arm0": far})
    turned = StandingArm(Pose(BEGIN_M, np.array([0.0, 0.6, 0.8, 0.0])), JOINTS_RAD)
    with pytest.raises(Conflict, match="arm0 stands too far"):
        require_near(way, {"arm0": turned})
    bent = StandingArm(Pose(BEGIN_M, DOWN), JOINTS_RAD + np.array([0, 0, 1.2, 0, 0, 0, 0]))
    with pytest.raises(Conflict, match=r"its joint 3 is 1\.20 rad from there"):
        require_near(way, {"arm0": bent})
    require_near(way, {"arm0": StandingArm(Pose(BEGIN_M + np.array([0.0, 0.2, 0.0]), DOWN), JOINTS_RAD)})


def test_what_jumps_or_does_not_go_on_is_no_way() -> None:
    data = swung()
    jumping = data.tool_positions_in_base.copy()
    jumping[30:, 0, 0] += 0.25
    with pytest.raises(InvalidInput, match=r"jumps by 0\.25 m after tick 29"):
        RecordedWay.of(replace(data, tool_positions_in_base=jumping), ARMS)
    standing = data.sim_time_s.copy()
    standing[7] = standing[6]
    with pytest.raises(InvalidInput, match="does not go on"):
        RecordedWay.of(replace(data, sim_time_s=standing), ARMS)
    with pytest.raises(InvalidInput, match="where the joints of arm0 were"):
        RecordedWay.of(replace(data, observations={}), ["arm0"])
