"""Short pieces of episodes, gathered by index: the data stay on the device, and no loader stands in the loop.

A window may start at every tick that has an action. Where it reaches over the end of its episode, the last observation
and the last action are repeated; where it reaches before the beginning, the first observation is: as robomimic pads.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from mart.trainer.data.dataset import Dataset


@dataclass(frozen=True)
class Shape:
    """Which ticks of a window are used, counted from its start."""

    seen: tuple[int, ...]
    acted: tuple[int, ...]
    goal: int

    @classmethod
    def sequence(cls, ticks: int) -> Shape:
        """Observations and actions of so many ticks, and what is seen after them."""
        return cls(tuple(range(ticks)), tuple(range(ticks)), ticks)

    @classmethod
    def chunk(cls, ticks: int) -> Shape:
        """Two observations, and the actions of so many ticks from the newer one on."""
        return cls((-1, 0), tuple(range(ticks)), ticks)


@dataclass(frozen=True)
class Batch:
    """B windows for each of S seeds.

    seen: float32[S, T, B, D]. goal: float32[S, B, D]. actions: float32[S, T', B, arms, 7].
    weights: float32[S, T', B, arms], how much each action counts; 1 on average over the data. None: all the same.
    """

    seen: Tensor
    goal: Tensor
    actions: Tensor
    weights: Tensor | None


class Windows:
    """Normalised observations and actions of all episodes, on one device."""

    def __init__(
        self, dataset: Dataset, seen: Tensor, weights: Tensor | None, shape: Shape, device: torch.device
    ) -> None:
        """seen: float32[rows, D], the observations as the networks take them. weights: float32[rows, arms]."""
        ends = torch.from_numpy(dataset.ends)
        first = torch.from_numpy(np.searchsorted(dataset.ends, dataset.ends, side="left"))
        starts = torch.from_numpy(dataset.starts)
        self.count, self.device = len(starts), device
        self._starts, self._first, self._last = (
            of.to(device) for of in (starts, first[starts], ends[starts])
        )
        self._seen, self._actions = seen.to(device), torch.from_numpy(dataset.actions).to(device)
        self._weights = None if weights is None else weights.to(device)
        self._seen_at, self._acted_at = (torch.tensor(of, device=device) for of in (shape.seen, shape.acted))
        self._goal_at = shape.goal

    def take(self, which: Tensor) -> Batch:
        """which: int64[S, B], numbers of windows in [0, count)."""
        start, first, last = (of[which][:, None] for of in (self._starts, self._first, self._last))
        seen = (start + self._seen_at[:, None]).clamp(first, last - 1)
        acted = (start + self._acted_at[:, None]).clamp(max=last - 1)
        goal = (start + self._goal_at).clamp(max=last)[:, 0]
        weights = None if self._weights is None else self._weights[acted]
        return Batch(self._seen[seen], self._seen[goal], self._actions[acted], weights)
