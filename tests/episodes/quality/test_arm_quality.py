from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mart.episodes.editing import edited
from mart.episodes.edits import EpisodeEdits
from mart.episodes.quality.arm_quality import arm_quality
from mart.episodes.quality.measures import ArmQuality
from tests.episodes.motions import motion

RATE_HZ = 20.0


def quality(edits: EpisodeEdits | None = None, arm: int = 0, **changes: object) -> ArmQuality:
    whole = replace(motion(100, (range(40, 80),)), **changes)  # type: ignore[arg-type]  # of a data class
    segments = edited(whole, edits or EpisodeEdits())
    late_s = np.zeros(sum(map(len, segments)))
    late_s[:10] = 0.2
    known = [np.zeros(len(segment), np.bool_) for segment in segments]
    return arm_quality(segments, arm, late_s, known, RATE_HZ)


def test_a_straight_way_with_a_rest() -> None:
    found = quality()
    assert found.path_m == pytest.approx(0.6)
    assert found.path_ratio == pytest.approx(1.0)
    assert (found.idle_s, found.idle_share) == pytest.approx((2.0, 0.4))
    assert (found.path_rad, found.regrasps, found.held_share) == (0.0, 0, 0.0)
    assert (found.waited_s, found.late_share) == pytest.approx((2.0, 0.1))
    assert found.engagements == 1


def test_each_arm_is_idle_by_itself() -> None:
    way = motion(100, (range(40, 80),)).tool_positions_in_base.copy()
    way[:, 1, 1] = 0.01 * np.arange(101)
    assert quality(tool_positions_in_base=way).idle_s == pytest.approx(2.0)
    assert quality(tool_positions_in_base=way, arm=1).idle_s == 0.0


def test_what_was_edited_out_is_not_measured() -> None:
    assert quality(edits=EpisodeEdits().with_cut("40-80")).idle_s == 0.0
    assert quality(edits=EpisodeEdits().with_skip("40-80")).path_m == pytest.approx(0.6)
    assert quality(edits=EpisodeEdits().with_cut("0-40")).path_m == pytest.approx(0.2)


def test_closings_after_the_first_are_regrasps_and_a_trembling_command_is_told_once() -> None:
    actions = motion(100).actions.copy()
    actions[10:20, 0, 6] = 1.0
    actions[30:40, 0, 6] = np.tile([0.9, 0.1, -0.1, 0.3, 0.9], 2)
    assert quality(actions=actions).regrasps == 1
    actions[50:60, 0, 6] = 1.0
    assert quality(actions=actions).regrasps == 2


def test_a_detour_is_seen_against_the_way_by_the_grasps() -> None:
    """Out and back with a grasp at the far end is straight; without a grasp, it leads nowhere."""
    way = np.zeros((101, 2, 3))
    way[:, :, 0] = np.concatenate([np.arange(50), np.arange(50, -1, -1)])[:, None] / 100
    actions = motion(100).actions.copy()
    actions[50:, 0, 6] = 1.0
    assert quality(tool_positions_in_base=way, actions=actions).path_ratio == pytest.approx(1.0)
    assert quality(tool_positions_in_base=way).path_ratio is None


def test_engagements_and_held_ticks_are_counted() -> None:
    flags = np.zeros((100, 2), np.bool_)
    flags[5:10, 0] = flags[50:60, 0] = True
    found = quality(engaged=flags, held=flags)
    assert (found.engagements, found.held_share) == pytest.approx((2, 0.15))
