"""Which evaluations of a run count as done: those in the same worlds, of checkpoints that are still there."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import pytest

from mart.trainer.evaluate.config import EvalConfig
from mart.trainer.evaluate.evaluation import EpisodeResult, Evaluation, append_evaluations
from mart.trainer.evaluate.evaluator import Evaluator
from mart.trainer.evaluate.world_seeds import Purpose
from mart.trainer.train.run_directory import RunDirectory

DONE = Evaluation(
    at_ns=0,
    model="HBC",
    task="two_arm_multi_cube_lifting",
    seed=0,
    updates=100,
    checkpoint="checkpoints/100/seed-0",
    purpose=Purpose.SELECTION,
    world_seed=0,
    time_limit_s=12.0,
    played=(EpisodeResult(seed=1, outcome="success", time_s=4.0, done=()),) * 3,
)
CONFIG = EvalConfig(episodes=3, score_episodes=3, time_limit_s=12.0)


@pytest.fixture
def run(tmp_path: Path) -> RunDirectory:
    run = RunDirectory(tmp_path)
    run.checkpoint(100, 0).mkdir(parents=True)
    return run


def known(run: RunDirectory, config: EvalConfig) -> list[Evaluation]:
    return Evaluator(cast("Any", None), config).known(run, Purpose.SELECTION)


@pytest.mark.parametrize(
    ("changes", "counts"),
    [
        ({}, True),
        ({"purpose": Purpose.SCORE}, False),
        ({"world_seed": 1}, False),
        ({"time_limit_s": 6.0}, False),
        ({"played": DONE.played[:2]}, False),
        ({"seed": 5}, False),  # its checkpoint is gone
    ],
)
def test_only_what_was_done_in_these_worlds_counts(
    run: RunDirectory, changes: dict[str, object], counts: bool
) -> None:
    append_evaluations(run.evaluations, [DONE.model_copy(update=changes)])
    assert bool(known(run, CONFIG)) is counts


def test_without_a_limit_of_its_own_any_limit_counts(run: RunDirectory) -> None:
    append_evaluations(run.evaluations, [DONE])
    assert known(run, EvalConfig(episodes=3, score_episodes=3)) == [DONE]
