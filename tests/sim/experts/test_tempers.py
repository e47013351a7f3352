"""Tempers trade one thing for another, and practice wears off what a novice lacks."""

from __future__ import annotations

from dataclasses import fields

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.runtime.skill_option import SKILLS
from mart.sim.experts import get_skill, skill_names
from mart.sim.experts.tempers import practised


def test_the_option_names_what_the_scripts_know() -> None:
    assert skill_names() == SKILLS


def test_who_is_quick_ends_wide_of_the_place_and_who_is_slow_does_not() -> None:
    hasty, average, careful = map(get_skill, ("hasty", "average", "careful"))
    assert hasty.speed_m_per_s > average.speed_m_per_s > careful.speed_m_per_s
    assert hasty.overshoot > average.overshoot > careful.overshoot
    assert hasty.aim_m > average.aim_m > careful.aim_m


def test_who_is_impatient_moves_like_anybody_and_acts_early() -> None:
    impatient, average = get_skill("impatient"), get_skill("average")
    assert impatient.speed_m_per_s == average.speed_m_per_s
    assert impatient.haste > average.haste
    assert impatient.settle_s < average.settle_s


@given(st.integers(1, 10_000))
def test_practice_goes_from_novice_towards_average_and_never_beyond(episode: int) -> None:
    now, later = practised(get_skill("learning"), episode), practised(get_skill("learning"), episode + 1)
    for field in fields(now):
        if field.name != "name":
            novice, average = (getattr(get_skill(name), field.name) for name in ("novice", "average"))
            low, high = sorted((novice, average))
            assert low <= getattr(now, field.name) <= high
            left, less = (abs(getattr(one, field.name) - average) for one in (now, later))
            assert less <= left


def test_the_first_episode_is_a_novices_and_half_is_learned_after_six() -> None:
    learning, novice, average = map(get_skill, ("learning", "novice", "average"))
    assert practised(learning, 1).aim_m == pytest.approx(novice.aim_m)
    left = (practised(learning, 6).aim_m - average.aim_m) / (novice.aim_m - average.aim_m)
    assert left == pytest.approx(0.49, abs=0.01)


@pytest.mark.parametrize("name", [name for name in SKILLS if name != "learning"])
def test_nobody_else_changes(name: str) -> None:
    assert practised(get_skill(name), 50) == get_skill(name)
