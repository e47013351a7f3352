"""Put an expert into a seat: an operator as any other, for one arm. Pure."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mart.operators.operator import Operator, SeatView, ToolTarget
from mart.protocol.tasks import Task
from mart.sim.experts.expert import Expert
from mart.sim.experts.skill import Skill


class ScriptedOperator(Operator):
    """Drive one arm as an expert of a skill does. The same seed, arm and episode give the same drives."""

    def __init__(self, task: Task, arm: str, skill: Skill, seed: int) -> None:
        self._task, self._arm, self._skill, self._seed = task, arm, skill, seed
        self._index = task.arm_names.index(arm)
        self._expert: Expert | None = None

    def begin(self, episode: int) -> None:
        """Start a new expert; see `Operator.begin`."""
        random = np.random.default_rng((self._seed, self._index, episode))
        self._expert = Expert(self._task, self._arm, self._skill, random)

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return what the expert wants; see `Operator.act`."""
        assert self._expert is not None  # begun before it acts
        return {self._arm: self._expert.act(view.observations, view.sim_time_s)}
