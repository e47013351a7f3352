"""Where no arm moves is found, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.idle import idle_ranges
from mart.protocol.errors import InvalidInput
from tests.episodes.motions import PERIOD_S, motion


def test_standing_still_is_found_at_both_ends_and_between() -> None:
    data = motion(100, still=(range(15), range(40, 60), range(90, 100)))
    assert idle_ranges(data, 0.5) == [(0, 15), (40, 60), (90, 100)]
    assert idle_ranges(data, 0.8) == [(40, 60)]
    assert idle_ranges(motion(30), 0.5) == []


def test_one_arm_that_moves_is_enough() -> None:
    data = motion(40, still=(range(10, 30),))
    positions = data.tool_positions_in_base.copy()
    positions[:, 1, 2] = 0.01 * np.arange(41)
    assert idle_ranges(replace(data, tool_positions_in_base=positions), 0.5) == []


def test_a_grip_is_not_idle() -> None:
    data = motion(60, still=(range(10, 50),))
    actions = data.actions.copy()
    actions[30:, 0, 6] = 1.0  # closes in transition 30
    assert idle_ranges(replace(data, actions=actions), 0.5) == [(10, 30), (31, 50)]


def test_creeping_is_moving() -> None:
    data = motion(80)
    slow = replace(data, tool_positions_in_base=data.tool_positions_in_base / 25)  # 8 mm a second
    assert idle_ranges(slow, 0.5) == []


def test_so_short_a_time_is_refused() -> None:
    for seconds in (0.0, 0.1, -1.0, float("nan")):
        with pytest.raises(InvalidInput, match=r"at least 0\.2 s"):
            idle_ranges(motion(10), seconds)


@given(start=st.integers(0, 300), length=st.integers(1, 300))
def test_one_stretch_is_found_to_the_tick(start: int, length: int) -> None:
    data = motion(start + length + 7, still=(range(start, start + length),))
    wanted = [(start, start + length)] if length * PERIOD_S >= 0.5 - 1e-9 else []
    assert idle_ranges(data, 0.5) == wanted
