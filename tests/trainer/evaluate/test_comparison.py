"""Paired comparisons: symmetric, honest about nothing, and right as often as they say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput
from mart.trainer.evaluate.comparison import compare_evaluations, compare_successes, mcnemar
from mart.trainer.evaluate.crossed import crossed_mean, rate_interval, t_quantile, t_tail
from mart.trainer.evaluate.evaluation import EpisodeResult, Evaluation, RolloutOutcome
from mart.trainer.evaluate.selection_bias import expected_best
from mart.trainer.evaluate.world_seeds import Purpose

_SHAPES = st.tuples(st.integers(1, 5), st.integers(2, 12))
_NAMES = ("a", "b")


def _tables(count: int) -> st.SearchStrategy[list[NDArray[np.bool_]]]:
    return _SHAPES.flatmap(lambda shape: st.lists(arrays(bool, shape), min_size=count, max_size=count))


@given(_tables(1))
def test_identical_runs_do_not_differ(tables: list[NDArray[np.bool_]]) -> None:
    found = compare_successes(tables[0], tables[0], _NAMES)
    assert (found.p_value, found.mcnemar_p, found.difference.value) == (1.0, 1.0, 0.0)
    assert found.interval[0] < 0.0 < found.interval[1]


@given(_tables(2))
def test_swapped_sides_say_the_same_the_other_way_round(tables: list[NDArray[np.bool_]]) -> None:
    first, second = tables
    one, other = compare_successes(first, second, _NAMES), compare_successes(second, first, _NAMES)
    assert one.p_value == pytest.approx(other.p_value)
    assert one.interval == pytest.approx((-other.interval[1], -other.interval[0]))
    assert (one.only_first, one.only_second) == (other.only_second, other.only_first)


@given(_tables(2))
def test_p_values_and_intervals_stay_in_their_bounds(tables: list[NDArray[np.bool_]]) -> None:
    found = compare_successes(tables[0], tables[1], _NAMES)
    assert 0.0 < found.p_value <= 1.0
    assert -1.0 <= found.interval[0] <= found.difference.value <= found.interval[1] <= 1.0
    low, high = rate_interval(tables[0])
    assert 0.0 <= low <= tables[0].mean() <= high <= 1.0


@given(_tables(2), st.randoms(use_true_random=False))
def test_the_order_of_seeds_and_worlds_does_not_matter(
    tables: list[NDArray[np.bool_]], random: object
) -> None:
    order = np.random.default_rng(random.getrandbits(32))  # type: ignore[attr-defined]
    rows, columns = (order.permutation(size) for size in tables[0].shape)
    first, second = (table[rows][:, columns] for table in tables)
    shuffled = compare_successes(first, second, _NAMES).p_value
    assert shuffled == pytest.approx(compare_successes(tables[0], tables[1], _NAMES).p_value)


def test_mcnemar_is_the_binomial_tail() -> None:
    assert mcnemar(0, 0) == 1.0
    assert mcnemar(0, 5) == pytest.approx(2 / 32)
    assert mcnemar(1, 9) == pytest.approx(2 * 11 / 1024)


@pytest.mark.parametrize(
    ("freedom", "quantile"), [(1, 12.7062), (2, 4.30265), (2.5, 3.5782), (4, 2.77645), (99, 1.98422)]
)
def test_students_quantiles_are_those_of_the_tables(freedom: float, quantile: float) -> None:
    assert t_quantile(0.975, freedom) == pytest.approx(quantile, rel=2e-3)
    assert t_tail(quantile, freedom) == pytest.approx(0.025, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("seeds", "spread", "least", "most"), [(5, 0.0, 0.93, 1.0), (3, 0.06, 0.93, 1.0)])
def test_intervals_hold_the_truth_as_often_as_they_say(
    seeds: int, spread: float, least: float, most: float
) -> None:
    """Seeds differ by `spread`, worlds are easier or harder for both; the difference is 10 points."""
    random = np.random.default_rng(7)
    difference, held, rate_held = 0.1, 0, 0
    times = 150
    for _ in range(times):
        ease = random.normal(0.0, 0.15, 60)
        offsets = random.normal(0.0, spread, (2, seeds, 1))
        chances = np.clip(0.5 + ease + offsets, 0.0, 1.0)
        first = random.random((seeds, 60)) < np.clip(chances[0] + difference, 0, 1)
        second = random.random((seeds, 60)) < chances[1]
        low, high = compare_successes(first, second, _NAMES).interval
        held += low <= difference <= high
        low, high = rate_interval(second)
        rate_held += low <= 0.5 <= high
    assert least <= held / times <= most
    assert least <= rate_held / times <= most


def test_a_variance_is_never_taken_for_zero() -> None:
    assert crossed_mean(np.ones((3, 10))).reach > 0.0
    assert compare_successes(np.ones((3, 10), bool), np.zeros((3, 10), bool), _NAMES).p_value > 0.0


def test_the_best_of_equal_checkpoints_shows_more_than_they_can() -> None:
    assert expected_best(0.5, 1, 30) == pytest.approx(0.5)
    assert expected_best(0.5, 10, 30) == pytest.approx(0.64, abs=0.005)
    assert expected_best(0.05, 10, 30) == pytest.approx(0.12, abs=0.005)
    assert expected_best(0.0, 10, 30) == 0.0
    assert math.isclose(expected_best(1.0, 10, 30), 1.0)


def _evaluation(
    seed: int, wins: str, task: str = "two_arm_multi_cube_lifting", first_world: int = 0
) -> Evaluation:
    played = tuple(
        EpisodeResult(
            seed=first_world + world,
            outcome=RolloutOutcome.SUCCESS if win == "+" else RolloutOutcome.TIME,
            time_s=1.0,
            done=(),
        )
        for world, win in enumerate(wins)
    )
    return Evaluation(
        at_ns=seed, model="HBC", task=task, seed=seed, updates=1, checkpoint="c", purpose=Purpose.SCORE, world_seed=0,
        time_limit_s=10.5, played=played,
    )  # fmt: skip


def test_only_pairs_of_one_seed_and_world_are_compared() -> None:
    first = [_evaluation(0, "++++"), _evaluation(1, "++++"), _evaluation(7, "----")]
    second = [_evaluation(0, "--", first_world=2), _evaluation(1, "+-++")]
    found = compare_evaluations(first, second)
    assert (found.seeds, found.worlds, found.only_first, found.only_second) == (2, 2, 2, 0)


def test_what_cannot_be_compared_is_said() -> None:
    with pytest.raises(InvalidInput, match="two_arm_drink_tray_lifting"):
        compare_evaluations([_evaluation(0, "++")], [_evaluation(0, "++", "two_arm_drink_tray_lifting")])
    with pytest.raises(InvalidInput, match="0 seeds"):
        compare_evaluations([_evaluation(0, "++")], [_evaluation(1, "++")])
    with pytest.raises(InvalidInput, match="mart eval"):
        compare_evaluations([_evaluation(0, "++")], [])
