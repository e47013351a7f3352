"""Remember what led a world out of its bounds: its last good states, and what was done in each."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from mart.protocol.errors import Corrupt
from mart.sim.scene.data import Array

KEPT = 5
_STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)


@dataclass(frozen=True, eq=False)
class LastStates:
    """Hold states, shape (n, size), oldest first, and actions, shape (n, arms, 7), whose last led out of bounds.

    A world of the same model, set to one of the states and stepped with the actions from there on, goes the same way.
    """

    task: str
    control_hz: float
    model_sha256: str
    states: Array
    actions: Array
    arm_kinds: tuple[str, ...] = ()


class Diverged(Corrupt):
    """Tell that the simulation went out of numerical bounds; only a reset helps."""

    def __init__(self, sim_time_s: float, last: LastStates) -> None:
        super().__init__(f"The world ran out of numerical bounds after {sim_time_s:.3f} s: reset it.")
        self.last = last


class StateHistory:
    """Keep the last states of one world, as they come."""

    def __init__(self, model: mujoco.MjModel, action_shape: tuple[int, ...]) -> None:
        self._states = np.zeros((KEPT, mujoco.mj_stateSize(model, _STATE)))
        self._actions = np.zeros((KEPT, *action_shape))
        self._count = 0

    def clear(self) -> None:
        """Forget all states so far."""
        self._count = 0

    def note(self, data: mujoco.MjData, actions: Array) -> None:
        """Note the state before a step, and what is to be done in it."""
        place = self._count % KEPT
        mujoco.mj_getState(data.model, data, self._states[place], _STATE)
        self._actions[place] = actions
        self._count += 1

    def states_and_actions(self) -> tuple[Array, Array]:
        """Return what is kept, oldest first: shapes (n, size) and (n, arms, 7)."""
        order = [number % KEPT for number in range(max(self._count - KEPT, 0), self._count)]
        return self._states[order], self._actions[order]
