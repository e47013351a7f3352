"""Step many worlds of one kind together on several threads.

The same physics, controller and lines of Python as in `World`: a batch gives the same bits as its worlds alone. What
they are between two steps is one integration state each; positions are worked out anew after every step.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from mujoco.batch import Batch, SimulationError
from numpy.typing import NDArray

from mart.protocol.batch_state import BatchState
from mart.sim.scene.data import Array, Flags
from mart.sim.tasks import scene_of
from mart.sim.world.control_interface import ControlInterface
from mart.sim.world.last_states import KEPT, Diverged
from mart.sim.world.progress import first_reasons
from mart.sim.world.world import FATAL_WARNINGS, World

_NOTHING, _POSITIONS = int(mujoco.mjtStage.mjSTAGE_NONE), int(mujoco.mjtStage.mjSTAGE_POS)


class WorldBatch:
    """Step `size` worlds like `world`, which stays in use: it makes the states of resets. Reset before all else.

    A world whose physics leaves its bounds stays as it was before that, for good, and has failed; `explain` says in
    words why.
    """

    def __init__(
        self, world: World, size: int, threads: int, explain: Callable[[Diverged], str] = str
    ) -> None:
        self._world, self._explain = world, explain
        self._batch = Batch(world.model, size, threads)
        self._interface = ControlInterface(scene_of(world.task), world.model, self._batch)
        self._status = self._interface.task_status()
        self._fatal_warnings = self._batch.warning[:, FATAL_WARNINGS, 1]
        self._diverged: dict[int, str] = {}
        self._history: deque[tuple[Array, Array, Flags]] = deque(maxlen=KEPT)  # states, actions, who went on

    def __len__(self) -> int:
        return int(self._batch.nsim)

    def reset(self, seeds: Sequence[int]) -> None:
        """Begin an episode in every world, as `World.reset` does."""
        self._batch.reset(stage=_NOTHING)
        for row, seed in zip(self._batch.state, seeds, strict=True):
            self._world.reset(seed)
            row[:] = np.frombuffer(self._world.integration_state(), "<f8")
        self._diverged.clear()
        self._history.clear()
        self._batch.forward(stage=_POSITIONS)
        self._status = self._interface.task_status()

    def step(self, actions: Array, running: Flags) -> None:
        """Advance the running worlds by one control period; actions: shape (worlds, arms, 7), finite."""
        going = running.copy()
        going[list(self._diverged)] = False
        before = self._batch.state.copy()
        self._history.append((before, actions, going.copy()))
        self._interface.command(actions)
        diverged = self._advance(np.flatnonzero(going))
        if len(diverged):
            self._batch.state[diverged] = before[diverged]
            self._batch.forward(diverged, stage=_POSITIONS)
            going[diverged] = False
        self._status = self._interface.settle()
        if not going.all():
            self._batch.state[~going] = before[~going]
            self._status = self._interface.task_status()
        for world in diverged.tolist():
            self._diverged[world] = self._explain(self._divergence(world))

    def _divergence(self, world: int) -> Diverged:
        history = [
            (states[world], actions[world]) for states, actions, going in self._history if going[world]
        ]
        states, actions = (np.array(part) for part in zip(*history, strict=True))
        return Diverged(float(self._batch.time[world]), self._world.last_states(states, actions))

    def _advance(self, going: NDArray[np.intp]) -> NDArray[np.intp]:
        """Step these worlds; return which of them left their bounds."""
        if not len(going):
            return going
        try:
            self._batch.step(going, nstep=self._world.substeps, stage=_POSITIONS)
        except SimulationError as error:
            broken = error.ids
        else:
            broken = going[:0]
        unstable = self._fatal_warnings[going].any(axis=1) | ~_bounded(self._batch.qvel[going])
        return np.union1d(going[unstable], broken)

    def integration_states(self) -> Array:
        """Return a copy of all states, shape (worlds, size), each as `World.integration_state` gives it."""
        self._interface.cast_shadows()
        return self._batch.state.copy()

    def standing(self, *, integration_states: bool = False) -> BatchState:
        """Return how every world stands."""
        status = self._status
        reasons = first_reasons(status.failed, len(self))
        for world, reason in self._diverged.items():
            reasons[world] = reason
        ticks = self._interface.success_ticks
        return BatchState(
            observations=self._interface.observations(),
            subtasks=np.stack([status.subtasks[s.name] for s in self._world.task.subtasks], axis=-1),
            success=ticks >= self._world.success_hold_ticks,
            failed=np.array([bool(reason) for reason in reasons]),
            sim_time_s=self._batch.time.copy(),
            success_ticks=ticks.astype(np.uint32),
            reasons=tuple(reasons),
            integration_states=self.integration_states() if integration_states else None,
        )


def _bounded(velocities: Array) -> Flags:
    """Return whether MuJoCo will go on from these, shape (worlds, nv), as mj_checkVel finds for one world."""
    return np.logical_and.reduce(np.abs(velocities) <= mujoco.mjMAXVAL, axis=-1)  # False for NaN
