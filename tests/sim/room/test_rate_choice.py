"""A live room's rate: the highest that the machine holds, without swinging."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.control_rate import OFFERED_CONTROL_HZ
from mart.sim.room.rate_choice import (
    FIRST_WAIT_S,
    HELD_FACTOR,
    HOLDS_BELOW,
    LONGEST_WAIT_S,
    RISES_BELOW,
    RateChoice,
    TickCost,
)

IDLE = TickCost(physics=0.04, tick_s=0.0005, picture_s=0.002, pictures=2, cores=8)
HEAVY = TickCost(
    physics=0.06, tick_s=0.001, picture_s=0.018, pictures=3, cores=2
)  # 20 Hz: 0.58 machines, 60: 1.7

COSTS = st.builds(
    TickCost,
    physics=st.floats(0.01, 1.0),
    tick_s=st.floats(0.0002, 0.01),
    picture_s=st.floats(0.0, 0.05),
    pictures=st.integers(0, 4),
    cores=st.integers(1, 32),
)
OWN = st.lists(st.sampled_from([10.0, 20.0, 30.0, 25.0]), max_size=2)


@pytest.mark.parametrize(
    ("cost", "control_hz"),
    [
        (IDLE, 60.0),
        (HEAVY, 20.0),
        (TickCost(physics=0.08, tick_s=0.001, picture_s=0.014, pictures=2, cores=2), 30.0),
        (
            TickCost(physics=0.02, tick_s=0.0, picture_s=0.019, pictures=1, cores=16),
            30.0,
        ),  # a seat draws on one core
        (
            TickCost(physics=4.0, tick_s=0.0, picture_s=0.0, pictures=0, cores=1),
            20.0,
        ),  # nothing holds: the lowest
    ],
)
def test_a_room_begins_with_the_highest_rate_that_leaves_something_to_spare(
    cost: TickCost, control_hz: float
) -> None:
    assert RateChoice(cost).control_hz == control_hz


def test_a_policy_of_twenty_sits_in_a_room_of_twenty_or_sixty() -> None:
    middling = TickCost(physics=0.08, tick_s=0.001, picture_s=0.014, pictures=2, cores=2)
    assert RateChoice(middling, [20.0]).control_hz == 20.0
    assert RateChoice(IDLE, [20.0, 30.0]).control_hz == 60.0
    assert RateChoice(IDLE, [25.0]).control_hz == 60.0  # it fits none, and says so itself
    came = RateChoice(middling)
    assert came.between_episodes(middling, 1.0, 0.0, [20.0]) == 20.0


def test_a_rate_that_is_not_held_falls_and_comes_back_after_a_wait() -> None:
    choice = RateChoice(IDLE)
    assert choice.between_episodes(IDLE, 0.9, 100.0) == 30.0
    assert choice.between_episodes(IDLE, 1.0, 100.0 + FIRST_WAIT_S - 1) == 30.0
    assert choice.between_episodes(IDLE, 1.0, 100.0 + FIRST_WAIT_S) == 60.0
    assert choice.between_episodes(IDLE, 0.9, 1000.0) == 30.0  # it was not held again: twice the wait
    assert choice.between_episodes(IDLE, 1.0, 1000.0 + FIRST_WAIT_S) == 30.0
    assert choice.between_episodes(IDLE, 1.0, 1000.0 + 2 * FIRST_WAIT_S) == 60.0


@given(cost=COSTS, seconds=st.lists(st.floats(0.0, 2000.0), max_size=20), own=OWN)
def test_what_stays_the_same_changes_nothing(cost: TickCost, seconds: list[float], own: list[float]) -> None:
    choice = RateChoice(cost, own)
    first = choice.control_hz
    rates = [choice.between_episodes(cost, 1.0, now_s, own) for now_s in sorted(seconds)]
    assert all(rate <= first for rate in rates)
    assert len(set(rates)) <= 1 or cost.use_at(first) > HOLDS_BELOW


@given(
    costs=st.lists(st.tuples(COSTS, st.floats(0.5, 1.0), st.floats(0.0, 300.0), OWN), min_size=1, max_size=30)
)
def test_it_offers_what_is_offered_falls_when_it_must_and_never_swings_up_early(
    costs: list[tuple[TickCost, float, float, list[float]]],
) -> None:
    choice, now_s, fell_s = RateChoice(costs[0][0]), 0.0, float("-inf")
    for cost, held, after_s, own in costs:
        before, now_s = choice.control_hz, now_s + after_s
        after = choice.between_episodes(cost, held, now_s, own)
        assert after in OFFERED_CONTROL_HZ
        if before not in choice._allowed(own):
            assert after in choice._allowed(own)
            continue
        if after > before:
            assert cost.use_at(after) <= RISES_BELOW
            assert now_s - fell_s >= FIRST_WAIT_S
        if held < HELD_FACTOR:
            assert after <= before
        if after < before:
            fell_s = now_s if held < HELD_FACTOR or cost.use_at(before) > HOLDS_BELOW else fell_s


@given(cost=COSTS, more=st.floats(1.0, 5.0))
def test_a_dearer_tick_never_begins_with_a_higher_rate(cost: TickCost, more: float) -> None:
    dearer = TickCost(
        cost.physics * more, cost.tick_s * more, cost.picture_s * more, cost.pictures, cost.cores
    )
    assert RateChoice(dearer).control_hz <= RateChoice(cost).control_hz


def test_the_wait_has_an_end() -> None:
    choice, now_s = RateChoice(IDLE), 0.0
    for _ in range(10):
        assert choice.between_episodes(IDLE, 0.5, now_s) == 30.0
        now_s += LONGEST_WAIT_S
        assert choice.between_episodes(IDLE, 1.0, now_s) == 60.0


@pytest.mark.parametrize(
    ("cost", "words"),
    [
        (TickCost(0.1, 0.001, 0.021, 1, 16), "pictures take 21 ms of each tick"),
        (TickCost(1.5, 0.0, 0.002, 1, 16), "the physics takes 25 ms of each tick"),
        (TickCost(0.1, 0.001, 0.014, 3, 2), "3 pictures of 14 ms and the physics share 2 cores"),
    ],
)
def test_what_takes_most_is_said_in_words(cost: TickCost, words: str) -> None:
    choice = RateChoice(IDLE)
    assert choice.between_episodes(cost, 1.0, 0.0) == 30.0
    assert choice.why == words
