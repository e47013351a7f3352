"""Smoothness depends on the motion alone: not on its rate, its length, its place or its size."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.episodes.quality.smoothness import Array, log_dimensionless_jerk

TOLERANCE = 0.1  # of rates; experts and novices are 0.7 to 1.3 apart


def reaching(seconds: float, rate_hz: float, tremor_m: float = 0.0) -> Array:
    """To and fro, 30 cm in 1.5 s, along a line that turns; with a tremor of 3 Hz."""
    t = np.arange(int(seconds * rate_hz) + 1) / rate_hz
    there = 0.15 * (1 - np.cos(2 * np.pi * t / 3.0))
    tremor = tremor_m * np.sin(2 * np.pi * 3.0 * t)
    return np.stack([there, 0.3 * there**2, tremor], axis=1)


def jerk(way: Array, rate_hz: float) -> float:
    found = log_dimensionless_jerk(way, rate_hz)
    assert found is not None
    return found


@given(tremor_m=st.floats(0.0, 0.02), rate_hz=st.sampled_from([30.0, 50.0, 60.0, 100.0]))
def test_rates_of_one_motion_agree(tremor_m: float, rate_hz: float) -> None:
    coarse, fine = reaching(12, 20.0, tremor_m), reaching(12, rate_hz, tremor_m)
    assert jerk(fine, rate_hz) == pytest.approx(jerk(coarse, 20.0), abs=TOLERANCE)


def test_a_tremor_is_less_smooth() -> None:
    values = [jerk(reaching(12, 20.0, tremor_m), 20.0) for tremor_m in (0.0, 0.002, 0.005, 0.01)]
    assert values == sorted(values, reverse=True)
    assert values[0] - values[-1] > 1.0


def test_a_longer_episode_of_the_same_motion_is_as_smooth() -> None:
    assert jerk(reaching(120, 20.0, 0.005), 20.0) == pytest.approx(
        jerk(reaching(12, 20.0, 0.005), 20.0), abs=0.15
    )


@given(scale=st.floats(0.5, 3.0), shift=st.floats(-5.0, 5.0))
def test_where_and_how_large_a_motion_is_does_not_matter(scale: float, shift: float) -> None:
    way = reaching(6, 20.0, 0.005)
    assert jerk(scale * way + shift, 20.0) == pytest.approx(jerk(way, 20.0), abs=1e-6)


@pytest.mark.parametrize("way", [np.zeros((400, 3)), reaching(1.0, 20.0)])
def test_what_does_not_move_or_is_too_short_has_none(way: Array) -> None:
    assert log_dimensionless_jerk(way, 20.0) is None
