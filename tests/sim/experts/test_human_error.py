from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.sim.experts import get_skill
from mart.sim.experts.human_error import CLOSING_S
from tests.sim.experts.humans import human


def test_each_level_is_worse_than_the_one_before_in_everything() -> None:
    expert, average, novice = (get_skill(name) for name in ("expert", "average", "novice"))
    for field in fields(expert):
        if field.name == "name":
            continue
        values = [getattr(skill, field.name) for skill in (expert, average, novice)]
        assert values == sorted(values, reverse=field.name in ("speed_m_per_s", "turn_rad_per_s")), field.name
        assert len(set(values)) == 3, field.name


def test_experts_are_never_hasty_and_let_nothing_slip() -> None:
    expert = human("expert")
    for _ in range(200):
        assert expert.closes_before_m() == 0.0
        assert expert.grips_s() >= CLOSING_S
        assert not expert.lets_slip(10.0)
        assert expert.pauses_s() == 0.0


def test_novices_are_hasty_as_often_as_their_skill_says() -> None:
    novice = human("novice")
    early = np.mean([novice.closes_before_m() > 0 for _ in range(2000)])
    assert early == pytest.approx(novice.skill.haste, abs=0.04)


@given(st.sampled_from([0.004, 0.05, 0.2]))
def test_slips_come_by_the_second_whatever_the_tick_rate(tick_s: float) -> None:
    clumsy = human("novice", slip_per_s=0.5)
    seconds = 2000
    slips = sum(clumsy.lets_slip(tick_s) for _ in range(round(seconds / tick_s)))
    # A tick in which it slips twice counts once.
    assert slips / seconds == pytest.approx((1 - np.exp(-0.5 * tick_s)) / tick_s, rel=0.15)


def test_aim_gets_better_with_every_attempt() -> None:
    misses = [
        [person_.aims() for _ in range(5)] for person_ in (human("novice", seed) for seed in range(300))
    ]
    spread = [float(np.std([row[attempt].position[0] for row in misses])) for attempt in range(5)]
    assert spread[0] == pytest.approx(get_skill("novice").aim_m, rel=0.15)
    assert spread == sorted(spread, reverse=True)
    assert spread[4] < 0.4 * spread[0]


def test_a_seed_decides_what_a_person_draws() -> None:
    def draws() -> list[float]:
        someone = human("average", seed=3)
        return [someone.reacts_s(), someone.settles_s(), *someone.aims().position, someone.grips_s()]

    assert draws() == draws()
