"""What a number of successes says about a policy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

_Z_95 = 1.959963984540054  # of the standard normal distribution, two-sided


@dataclass(frozen=True)
class Rate:
    """Tell `hits` of `trials`, and where the true rate lies with 95 % confidence."""

    hits: int
    trials: int

    @property
    def value(self) -> float:
        """The share of hits, 0 … 1; 0 of none."""
        return self.hits / self.trials if self.trials else 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's score interval (E. B. Wilson, JASA 22, 1927): holds for few trials and at 0 and 1; 0 … 1 of none."""
        if self.trials == 0:
            return 0.0, 1.0
        n, p, z2 = self.trials, self.value, _Z_95**2
        center = (p + z2 / (2 * n)) / (1 + z2 / n)
        half = _Z_95 * math.sqrt(p * (1 - p) / n + z2 / (4 * n * n)) / (1 + z2 / n)
        low = 0.0 if self.hits == 0 else max(0.0, center - half)
        high = 1.0 if self.hits == n else min(1.0, center + half)
        return low, high

    def __str__(self) -> str:
        low, high = self.interval
        return f"{100 * self.value:.1f} % ({100 * low:.0f}–{100 * high:.0f})"


@dataclass(frozen=True)
class Spread:
    """Mean and population standard deviation (ddof 0): what the paper's ± is, see docs/how-to-evaluate-policies.md."""

    mean: float
    deviation: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Return the spread of at least one value."""
        mean = math.fsum(values) / len(values)
        return cls(mean, math.sqrt(math.fsum((value - mean) ** 2 for value in values) / len(values)))
