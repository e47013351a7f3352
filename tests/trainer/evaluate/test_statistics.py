"""Rates, spreads, seeds and protocols: what is said about policies, without any policy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import Corrupt
from mart.trainer.evaluate.evaluation import (
    EpisodeResult,
    Evaluation,
    append_evaluations,
    best_evaluation,
    read_evaluations,
)
from mart.trainer.evaluate.statistics import Rate, Spread
from mart.trainer.evaluate.success_rates import success_rates
from mart.trainer.evaluate.world_seeds import Purpose, world_seeds

TASK = "two_arm_multi_cube_lifting"
SUBTASKS = ("lift_cube0", "lift_cube1")


def evaluation(
    successes: int,
    episodes: int = 30,
    seed: int = 0,
    updates: int = 100,
    purpose: Purpose = Purpose.SELECTION,
) -> Evaluation:
    """Its failures have lifted one cube."""
    won = EpisodeResult(seed=1, outcome="success", time_s=4.0, done=SUBTASKS)
    lost = EpisodeResult(seed=2, outcome="time", time_s=12.0, done=SUBTASKS[:1])
    return Evaluation(
        at_ns=0,
        model="HBC",
        task=TASK,
        seed=seed,
        updates=updates,
        checkpoint=f"checkpoints/{updates}/seed-{seed}",
        purpose=purpose,
        world_seed=0,
        time_limit_s=12.0,
        played=(won,) * successes + (lost,) * (episodes - successes),
    )


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_an_interval_holds_the_rate_and_mirrors_that_of_the_failures(counted: tuple[int, int]) -> None:
    hits, trials = counted
    low, high = Rate(hits, trials).interval
    assert 0 <= low <= hits / trials <= high <= 1
    assert Rate(trials - hits, trials).interval == pytest.approx((1 - high, 1 - low))


def test_wilsons_interval_is_the_published_one() -> None:
    # R. G. Newcombe, Statistics in Medicine 17 (1998), table I, method 3
    for hits, trials, interval in (
        (81, 263, (0.2553, 0.3662)),
        (15, 148, (0.0624, 0.1605)),
        (0, 20, (0.0, 0.1611)),
        (1, 29, (0.0061, 0.1718)),
    ):
        assert Rate(hits, trials).interval == pytest.approx(interval, abs=5e-5)


def test_the_interval_covers_the_truth_as_often_as_it_says() -> None:
    hits = np.random.default_rng(0).binomial(100, 0.8, size=2000)
    covered = [low <= 0.8 <= high for low, high in (Rate(int(h), 100).interval for h in hits)]
    assert np.mean(covered) == pytest.approx(0.95, abs=0.02)


def test_the_deviation_is_that_of_the_population() -> None:
    assert Spread.of([1.0, 2.0, 3.0, 4.0]) == Spread(2.5, 1.25**0.5)
    assert Spread.of([0.3]) == Spread(0.3, 0.0)


def test_worlds_are_shared_by_models_and_apart_by_purpose() -> None:
    selection, score = (world_seeds(purpose, 0, 100) for purpose in Purpose)
    assert selection[:30] == world_seeds(Purpose.SELECTION, 0, 30)
    assert not set(selection) & set(score)
    assert not set(selection) & set(world_seeds(Purpose.SELECTION, 1, 100))
    assert min(selection + score) > 2**32  # collected episodes have smaller seeds
    assert max(selection + score) < 2**63


def test_both_protocols_take_the_best_checkpoint_of_each_seed() -> None:
    found = success_rates(
        [
            evaluation(10, seed=0, updates=100),
            evaluation(20, seed=0, updates=200),
            evaluation(5, seed=0, updates=300),
            evaluation(30, seed=1, updates=100),
            evaluation(60, 100, seed=0, updates=200, purpose=Purpose.SCORE),
            evaluation(80, 100, seed=1, updates=100, purpose=Purpose.SCORE),
            evaluation(1, 100, seed=0, updates=100, purpose=Purpose.SCORE),  # was the best one once
        ]
    )
    assert found is not None
    assert (found.seeds, found.episodes) == ((0, 1), 30)
    assert found.paper == Spread.of([20 / 30, 1.0])
    assert found.honest == Spread.of([0.6, 0.8])
    assert found.pooled == Rate(140, 200)


def test_of_equally_good_checkpoints_the_longest_trained_is_chosen() -> None:
    first, last = evaluation(9, updates=100), evaluation(9, updates=200)
    assert best_evaluation([first, last]) == best_evaluation([last, first]) == last


def test_no_evaluation_is_no_judgement() -> None:
    assert success_rates([]) is None
    assert success_rates([evaluation(3, purpose=Purpose.SCORE)]) is None


def test_an_evaluation_tells_what_was_reached_and_where_it_failed() -> None:
    found = evaluation(20)
    assert found.done == {"lift_cube0": 30, "lift_cube1": 20}
    assert found.failures == {"lift_cube1": 10}
    assert found.mean_success_time_s == 4.0
    assert evaluation(0).mean_success_time_s is None


def test_lines_survive_a_torn_one(tmp_path: Path) -> None:
    path = tmp_path / "evaluations.jsonl"
    assert read_evaluations(path) == []
    append_evaluations(path, [evaluation(1), evaluation(2)])
    whole = path.read_bytes()
    path.write_bytes(whole[:-40])
    assert read_evaluations(path) == [evaluation(1)]
    append_evaluations(path, [evaluation(3)])
    assert read_evaluations(path) == [evaluation(1), evaluation(3)]


def test_a_line_that_is_no_evaluation_is_said(tmp_path: Path) -> None:
    path = tmp_path / "evaluations.jsonl"
    path.write_text('{"seed": 1}\n')
    with pytest.raises(Corrupt):
        read_evaluations(path)
