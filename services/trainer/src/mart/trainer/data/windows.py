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
from mart.trainer.data.tool_targets import ToolTargets


@dataclass(frozen=True)
class WindowSpec:
    """Which ticks of a window are used, each counted from the window's start.

    obs: of the observations, action: of the actions, goal: of the one observation that is the subgoal.
    """

    obs: tuple[int, ...]
    actions: tuple[int, ...]
    goal: int

    @classmethod
    def sequence(cls, ticks: int) -> WindowSpec:
        """Return the spec of `ticks` observations and actions, with the observation after them as the goal."""
        return cls(tuple(range(ticks)), tuple(range(ticks)), ticks)

    @classmethod
    def chunk(cls, ticks: int, seen: int = 1) -> WindowSpec:
        """Return the spec of `ticks` actions, and the observations of the first `seen` of them and one before."""
        return cls(tuple(range(-1, seen)), tuple(range(ticks)), ticks)


@dataclass(frozen=True)
class WindowBatch:
    """B windows for each of S seeds.

    obs: float32[S, T, B, D]. goal: float32[S, B, D]. actions: float32[S, T', B, arms, 7].
    weights: float32[S, T', B, arms], how much each action counts; 1 on average over the data. None: all the same.
    """

    obs: Tensor
    goal: Tensor
    actions: Tensor
    weights: Tensor | None


class Windows:
    """Hold the normalised observations and the actions of all episodes on one device, and gather windows of them."""

    def __init__(
        self,
        dataset: Dataset,
        obs: Tensor,
        weights: Tensor | None,
        spec: WindowSpec,
        device: torch.device,
        *,
        targets: ToolTargets | None = None,
    ) -> None:
        """Gather from obs, float32[rows, D], as networks take them, with weights, float32[rows, arms].

        targets: actions become poses from where the tool is as a window starts; None: they stay as they are.
        """
        ends = torch.from_numpy(dataset.ends)
        first = torch.from_numpy(np.searchsorted(dataset.ends, dataset.ends, side="left"))
        starts = torch.from_numpy(dataset.starts)
        self.count, self.device = len(starts), device
        self._starts, self._first, self._last = (
            of.to(device) for of in (starts, first[starts], ends[starts])
        )
        self._obs, self._actions = obs.to(device), torch.from_numpy(dataset.actions).to(device)
        self._weights = None if weights is None else weights.to(device)
        self._obs_ticks, self._action_ticks = (
            torch.tensor(of, device=device) for of in (spec.obs, spec.actions)
        )
        self._goal_tick = spec.goal
        self._targets = targets
        if targets is not None:
            self._tools = targets.poses(torch.from_numpy(dataset.observations)).to(device)

    def take(self, which: Tensor) -> WindowBatch:
        """Gather the windows with these numbers. which: int64[S, B], each in [0, count)."""
        start, first, last = (of[which][:, None] for of in (self._starts, self._first, self._last))
        obs = (start + self._obs_ticks[:, None]).clamp(first, last - 1)
        actions = (start + self._action_ticks[:, None]).clamp(max=last - 1)
        goal = (start + self._goal_tick).clamp(max=last)[:, 0]
        weights = None if self._weights is None else self._weights[actions]
        return WindowBatch(self._obs[obs], self._obs[goal], self._done(actions, start), weights)

    def actions(self, most: int = 4096) -> Tensor:
        """Return the actions of at most so many windows, evenly spread: float32[N, arms * 7]."""
        which = torch.arange(0, self.count, max(1, self.count // most), device=self.device)
        return self.take(which[None]).actions.flatten(-2).flatten(0, -2)

    def _done(self, actions: Tensor, start: Tensor) -> Tensor:
        """Return what was done in these rows, int64[S, T', B], of windows that start at int64[S, 1, B]."""
        if self._targets is None:
            return self._actions[actions]
        return self._targets.absolute(self._actions[actions], self._tools[actions], self._tools[start])
