"""Means over seeds and worlds that cross: every seed's policy plays every world, and both were drawn by chance.

Episodes of one seed resemble one another, and so do those of one world, so they are not as many independent trials as
there are episodes. The variance of their mean is that of the crossed two-way layout without replication, MS_seeds +
MS_worlds - MS_rest over the number of episodes, with Satterthwaite's degrees of freedom (Biometrics Bulletin 2, 1946;
Searle, Casella and McCulloch, Variance Components, 1992, chapter 5). With few seeds this is wide, as it should be:
three trainings hardly tell how trainings differ. Of one seed nothing can be said but of its worlds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import InvalidInput

_GRID = np.linspace(-math.pi / 2, math.pi / 2, 4_001)


@dataclass(frozen=True)
class CrossedMean:
    """A mean over seeds and worlds. standard_error: of it. freedom: degrees of freedom of that."""

    value: float
    standard_error: float
    freedom: float

    @property
    def reach(self) -> float:
        """Half the width of the 95 % interval."""
        return self.standard_error * t_quantile(0.975, self.freedom)

    @property
    def p_value(self) -> float:
        """How likely a mean at least this far from 0 is, on either side, where the true one is 0."""
        if self.value == 0.0:
            return 1.0
        return 2 * t_tail(abs(self.value) / self.standard_error, self.freedom)


def crossed_mean(table: NDArray[np.float64]) -> CrossedMean:
    """Return the mean of float64[seeds, worlds]. Raises InvalidInput without a seed, or with fewer than two worlds.

    The variance is at least what one episode that had gone otherwise would have made: no sample is proof of 0.
    """
    seeds, worlds = table.shape
    if seeds < 1 or worlds < 2:
        raise InvalidInput(
            f"{seeds} seeds in {worlds} worlds were given; give one seed and two worlds at least."
        )
    mean = float(table.mean())
    rows, columns = table.mean(1), table.mean(0)
    of_worlds = seeds * float(((columns - mean) ** 2).sum()) / (worlds - 1)
    least = 1.0 / table.size
    if seeds == 1:
        return CrossedMean(mean, math.sqrt(max(of_worlds, least) / worlds), worlds - 1)
    of_seeds = worlds * float(((rows - mean) ** 2).sum()) / (seeds - 1)
    rest = float(((table - rows[:, None] - columns + mean) ** 2).sum()) / ((seeds - 1) * (worlds - 1))
    of_seeds, of_worlds = max(of_seeds, rest), max(of_worlds, rest)
    total = of_seeds + of_worlds - rest
    if total <= least * (1 + 1e-9):  # as where a single episode went otherwise
        return CrossedMean(mean, math.sqrt(least / table.size), worlds - 1)
    freedom = total**2 / (
        of_seeds**2 / (seeds - 1) + of_worlds**2 / (worlds - 1) + rest**2 / ((seeds - 1) * (worlds - 1))
    )
    return CrossedMean(mean, math.sqrt(total / table.size), freedom)


def rate_interval(successes: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the 95 % interval of a success rate from bool[seeds, worlds], within 0 … 1.

    Wilson's score interval with as many trials as the crossed variance says the episodes are worth, and Student's
    quantile in place of the normal one: holds where every episode, or none, succeeded.
    """
    found = crossed_mean(successes.astype(float))
    share, trials = found.value, float(successes.size)
    plain = share * (1 - share) / trials
    worth = trials if plain == 0.0 else trials / max(1.0, found.standard_error**2 / plain)
    quantile = t_quantile(0.975, successes.shape[1] - 1 if plain == 0.0 else found.freedom)
    squared = quantile**2
    center = (share + squared / (2 * worth)) / (1 + squared / worth)
    half = (
        quantile * math.sqrt(share * (1 - share) / worth + squared / (4 * worth**2)) / (1 + squared / worth)
    )
    return (0.0 if share == 0.0 else max(0.0, center - half)), (
        1.0 if share == 1.0 else min(1.0, center + half)
    )


def t_tail(t: float, freedom: float) -> float:
    """Return the probability that Student's t exceeds `t`."""
    return 1.0 - float(np.interp(math.atan(t / math.sqrt(freedom)), _GRID, _distribution(freedom)))


def t_quantile(probability: float, freedom: float) -> float:
    """Return the value that Student's t is below with this probability, for any degrees of freedom above 0."""
    return math.sqrt(freedom) * math.tan(float(np.interp(probability, _distribution(freedom), _GRID)))


def _distribution(freedom: float) -> NDArray[np.float64]:
    """Return P(angle <= _GRID): where t = sqrt(freedom) * tan(angle), the angle's density goes as cos^(freedom - 1)."""
    middles = (_GRID[1:] + _GRID[:-1]) / 2
    total = np.concatenate([[0.0], np.cumsum(np.cos(middles) ** (freedom - 1))])
    return total / total[-1]
