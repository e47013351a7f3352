"""A run's success rate, by the paper's protocol and by an honest one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mart.trainer.evaluate.evaluation import Evaluation, best_evaluation
from mart.trainer.evaluate.statistics import Rate, Spread
from mart.trainer.evaluate.world_seeds import Purpose


@dataclass(frozen=True)
class SuccessRates:
    """What the seeds of one model on one task achieve, as shares of episodes.

    paper: the best checkpoint of each seed, in the worlds in which it was found to be the best. honest: the same
    checkpoints in fresh worlds; None before they were scored. pooled: all fresh episodes of all seeds.
    """

    seeds: tuple[int, ...]
    episodes: int
    paper: Spread
    honest: Spread | None
    pooled: Rate | None


def success_rates(evaluations: Iterable[Evaluation]) -> SuccessRates | None:
    """Return the rates of one model on one task; None where no checkpoint was evaluated."""
    found = list(evaluations)
    chosen = [best_evaluation(own) for own in _by_seed(found, Purpose.SELECTION)]
    if not chosen:
        return None
    rates = [score.rate for score in best_scores(found)]
    return SuccessRates(
        seeds=tuple(choice.seed for choice in chosen),
        episodes=len(chosen[0].played),
        paper=Spread.of([choice.rate.value for choice in chosen]),
        honest=Spread.of([rate.value for rate in rates]) if rates else None,
        pooled=Rate(sum(rate.hits for rate in rates), sum(rate.trials for rate in rates)) if rates else None,
    )


def best_scores(evaluations: Iterable[Evaluation]) -> list[Evaluation]:
    """Return the newest score in fresh worlds of each seed's best checkpoint, of the seeds that have one."""
    found = list(evaluations)
    chosen = [best_evaluation(own) for own in _by_seed(found, Purpose.SELECTION)]
    keys = {(choice.seed, choice.updates) for choice in chosen}
    return [own[-1] for own in _by_seed([f for f in found if (f.seed, f.updates) in keys], Purpose.SCORE)]


def _by_seed(evaluations: Sequence[Evaluation], purpose: Purpose) -> list[list[Evaluation]]:
    of_purpose = [found for found in evaluations if found.purpose is purpose]
    seeds = sorted({found.seed for found in of_purpose})
    return [[found for found in of_purpose if found.seed == seed] for seed in seeds]
