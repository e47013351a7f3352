"""Scripted operators: they watch the bus, and drive the seats that are theirs, as people would.

An operator sees the observations of its own arm only. It gives one command for every state; while no new state comes
it repeats that command under growing numbers, so that the barrier hears that it is still there.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Corrupt
from mart.protocol.messages import OPERATOR_SCRIPT, Command, CommandStamps, State, pose_message
from mart.protocol.tasks import Observation, Task
from mart.sim.experts import Expert, ExpertIntent, Skill

REPEAT_S = 0.1


class ScriptedOperator:
    """Drives one arm under one seat epoch. Pure: states in, commands out."""

    def __init__(self, task: Task, arm: str, epoch: int, skill: Skill, seed: int) -> None:
        self.epoch = epoch
        self._task, self._arm, self._skill, self._seed = task, arm, skill, seed
        self._index = task.arm_names.index(arm)
        self._expert: Expert | None = None
        self._intent: ExpertIntent | None = None
        self._seen = (0, 0)  # boot, tick
        self._sequence = 0

    def see(self, state: State) -> bool:
        """Whether `state` was news. Raises Corrupt where it does not show what this arm's operator should see."""
        if (state.boot, state.tick) == self._seen:
            return False
        sight = sight_of(state, self._task.observations_of(self._arm))
        mine = next((arm for arm in state.arms if arm.arm == self._arm), None)
        if mine is None:
            raise Corrupt(f"A state without {self._arm} came.")
        if self._expert is None or not mine.action or state.boot != self._seen[0]:  # the world was reset
            random = np.random.default_rng((self._seed, self._index, state.episode))
            self._expert = Expert(self._task, self._arm, self._skill, random)
        self._seen = (state.boot, state.tick)
        self._sequence = max(
            self._sequence, mine.sequence
        )  # whoever drove under this epoch before has counted so far
        self._intent = self._expert.act(sight, state.sim_time_s)
        return True

    def command(self, wall_ns: int) -> Command | None:
        """What the operator wants now; None before it has seen anything."""
        if self._intent is None:
            return None
        self._sequence += 1
        return Command(
            arm=self._arm,
            seat_epoch=self.epoch,
            sequence=self._sequence,
            target_tool_in_base=pose_message(self._intent.target_tool_in_base),
            gripper=self._intent.gripper,
            engaged=self._intent.engaged,
            source=OPERATOR_SCRIPT,
            stamps=CommandStamps(sent_ns=wall_ns),
            seen_tick=self._seen[1],
        )


def sight_of(state: State, visible: Iterable[Observation]) -> dict[str, NDArray[np.float64]]:
    """The `visible` observations in `state`, in their shapes. Raises Corrupt where one is missing or misshapen."""
    values = {observation.name: observation.value for observation in state.observations}
    try:
        return {
            observation.name: np.array(values[observation.name], dtype=np.float64).reshape(observation.shape)
            for observation in visible
        }
    except (KeyError, ValueError) as error:
        raise Corrupt(f"A state came without what an operator should see: {error}.") from error
