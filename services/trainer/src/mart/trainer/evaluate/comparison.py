"""Compare two models by pairs of episodes: the same seed's policies in the same world."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput
from mart.trainer.evaluate.crossed import CrossedMean, crossed_mean
from mart.trainer.evaluate.evaluation import Evaluation
from mart.trainer.evaluate.world_seeds import Purpose


@dataclass(frozen=True)
class PairedComparison:
    """Compare `first` with `second`. seeds, worlds: of the pairs. only_first, only_second: pairs that one alone won.

    difference: of the success rates, first less second. mcnemar_p: whether these very policies differ, over worlds
    (exact); p_value: whether trainings differ, over seeds and worlds, and never below the other.
    """

    first: str
    second: str
    seeds: int
    worlds: int
    only_first: int
    only_second: int
    difference: CrossedMean
    mcnemar_p: float

    @property
    def p_value(self) -> float:
        """The p-value over seeds and worlds."""
        return min(1.0, max(self.difference.p_value, self.mcnemar_p))

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the difference, over seeds and worlds where there are two seeds or more."""
        value, reach = self.difference.value, self.difference.reach
        return max(-1.0, value - reach), min(1.0, value + reach)


def mcnemar(only_first: int, only_second: int) -> float:
    """Return the exact two-sided p-value of McNemar's test (Psychometrika 12, 1947); 1 without a pair that differs."""
    pairs = only_first + only_second
    if pairs == 0:
        return 1.0
    tail = sum(math.comb(pairs, hits) for hits in range(min(only_first, only_second) + 1))
    return min(1.0, 2 * tail / 2**pairs)


def compare_successes(
    first: NDArray[np.bool_], second: NDArray[np.bool_], names: tuple[str, str]
) -> PairedComparison:
    """Compare bool[seeds, worlds] of two models. Raises InvalidInput where there are fewer than two worlds."""
    seeds, worlds = first.shape
    only_first, only_second = int((first & ~second).sum()), int((second & ~first).sum())
    difference = crossed_mean(first.astype(float) - second.astype(float))
    return PairedComparison(
        *names, seeds, worlds, only_first, only_second, difference, mcnemar(only_first, only_second)
    )


def compare_evaluations(
    first: Iterable[Evaluation], second: Iterable[Evaluation], purpose: Purpose = Purpose.SCORE
) -> PairedComparison:
    """Compare the evaluations of one purpose of two models, by the seeds and worlds that both have.

    Where a seed was scored twice, the newest counts. Raises InvalidInput where the two are of different tasks or time
    limits, or share no seed or fewer than two worlds.
    """
    sides = [_by_seed(side, purpose) for side in (first, second)]
    if not all(sides):
        raise InvalidInput(
            f"One of the two has no evaluation for {purpose}; `mart eval --checkpoint RUN` makes one."
        )
    one, other = sides
    kinds = {(found.task, found.time_limit_s) for side in sides for found in side.values()}
    if len(kinds) > 1:
        told = "; ".join(f"{task}, {limit_s:g} s" for task, limit_s in sorted(kinds))
        raise InvalidInput(f"Evaluations of {told} were given; compare runs of one task and time limit.")
    seeds = sorted(one.keys() & other.keys())
    worlds = _shared_worlds([side[seed] for side in sides for seed in seeds]) if seeds else []
    if len(worlds) < 2:
        raise InvalidInput(
            f"The two share {len(seeds)} seeds ({_listed(one)} and {_listed(other)}) and {len(worlds)} worlds in them; "
            "train with the same seeds and judge with the same --seed."
        )
    names = (next(iter(one.values())).model, next(iter(other.values())).model)
    return compare_successes(_successes(one, seeds, worlds), _successes(other, seeds, worlds), names)


def successes_by_world(evaluations: Iterable[Evaluation], purpose: Purpose) -> NDArray[np.bool_] | None:
    """Return bool[seeds, worlds] of one model, of the worlds that all its seeds played; None without two."""
    found = _by_seed(evaluations, purpose)
    worlds = _shared_worlds(list(found.values())) if found else []
    return _successes(found, sorted(found), worlds) if len(worlds) > 1 else None


def _by_seed(evaluations: Iterable[Evaluation], purpose: Purpose) -> dict[int, Evaluation]:
    of_purpose = [found for found in evaluations if found.purpose is purpose]
    return {found.seed: found for found in sorted(of_purpose, key=lambda found: found.at_ns)}


def _shared_worlds(evaluations: list[Evaluation]) -> list[int]:
    played = [{result.seed for result in found.played} for found in evaluations]
    return sorted(set.intersection(*played))


def _successes(found: Mapping[int, Evaluation], seeds: Iterable[int], worlds: list[int]) -> NDArray[np.bool_]:
    rows = [{result.seed: result.succeeded for result in found[seed].played} for seed in seeds]
    return np.array([[row[world] for world in worlds] for row in rows], bool)


def _listed(found: Mapping[int, Evaluation]) -> str:
    return ", ".join(map(str, sorted(found)))
