"""Put an expert into a seat: an operator as any other, for one arm, that obeys its partners' cues. Pure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mart.operators.obedience import Obedience
from mart.operators.operator import Operator, SeatView, ToolTarget
from mart.protocol.messages import CUE_COME_CLOSER, CUE_GO, CUE_LET_GO, Cue
from mart.protocol.tasks import Task
from mart.sim.experts.expert import Expert
from mart.sim.experts.skill import Skill
from mart.sim.experts.tempers import practised


class ScriptedOperator(Operator):
    """Drive one arm as an expert of a skill does. The same seed, arm, episode and cues give the same drives.

    Its expert's clock stands still while it waits and runs half as fast while it is slow: plans know nothing of it.
    """

    _obedience: Obedience
    _seen_s: float | None  # the world's clock, at the newest act
    _lost_s: float  # by which the expert's clock is behind the world's
    _held: ToolTarget | None  # what holds the arm still
    _opens: bool  # while it waits, where that was asked

    def __init__(self, task: Task, arm: str, skill: Skill, seed: int) -> None:
        self._task, self._arm, self._skill, self._seed = task, arm, skill, seed
        self._index = task.arm_names.index(arm)
        self._expert: Expert | None = None
        self._forget()

    def begin(self, episode: int) -> None:
        """Start a new expert that was told nothing; see `Operator.begin`."""
        random = np.random.default_rng((self._seed, self._index, episode))
        self._expert = Expert(self._task, self._arm, practised(self._skill, episode), random)
        self._forget()

    def on_cue(self, cue: Cue, arm: str) -> None:
        """Obey from the next `act` on; see `Operator.on_cue`."""
        assert self._expert is not None  # begun before it hears
        self._obedience = self._obedience.after(cue)
        if cue == CUE_GO:
            self._expert.go_on()
        elif cue == CUE_LET_GO:
            self._opens = True
            self._expert.let_go()
        elif cue == CUE_COME_CLOSER:
            self._expert.come_closer(arm)

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        """Return what the expert wants; see `Operator.act`."""
        assert self._expert is not None  # begun before it acts
        if self._seen_s is not None:
            self._lost_s += (1.0 - self._obedience.pace) * max(view.sim_time_s - self._seen_s, 0.0)
        self._seen_s = view.sim_time_s
        if self._obedience.waits:
            return {self._arm: self._hold(self._expert, view)}
        self._held, self._opens = None, False
        return {self._arm: self._expert.act(view.observations, view.sim_time_s - self._lost_s)}

    def _hold(self, expert: Expert, view: SeatView) -> ToolTarget:
        self._held = self._held or expert.pause(view.poses_tool_in_base[self._arm])
        if self._opens:
            self._held = replace(self._held, gripper=0.0)
        return self._held

    def _forget(self) -> None:
        self._obedience = Obedience()
        self._seen_s = None
        self._lost_s = 0.0
        self._held = None
        self._opens = False
