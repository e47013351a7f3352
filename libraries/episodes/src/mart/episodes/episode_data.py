"""One episode as numpy arrays: what was seen, what was done then, what came of it (docs/protocol.md, section 3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64] | slice


@dataclass(frozen=True)
class EpisodeData:
    """Hold T transitions of one episode: row t of `actions` leads from row t of `observations` to row t + 1.

    arms: names, in the order of the axis `arms`.
    ticks: int64[T + 1], which tick of the recorded episode each state is, 0 the one after the reset.
    observations: by name, each float64[T + 1, *shape]; quaternions are wxyz.
    actions: float64[T, arms, 7], as applied, in [-1, 1]: a step of the tool (6 numbers), then the gripper.
    sources: int8[T, arms], who drove the arm in that tick (mart.v1.Operator).
    engaged: bool[T, arms], whether the arm's operator had the clutch held in that tick.
    held: bool[T, arms], whether the arm was held in that tick, since no new command of its operator's was there.
    holders: int16[T, arms], who held the arm's seat in that tick: a row of `holder_names`, -1 where that is unknown.
    holder_names: such as `human Ana`, `policy act` and `hold`, each once.
    subtasks: by name, each bool[T + 1], whether it was done.
    success: bool[T + 1], whether the task was done.
    sim_time_s: float64[T + 1], simulated seconds, as the world counted them.
    sent_ns: int64[T + 1], Unix time at which the room sent the state.
    integration_states: float64[T + 1, size], MuJoCo's, from which a simulation can go on; size 0 where not wanted.
    tool_positions_in_base: float64[T + 1, arms, 3], measured, in each arm's base frame.
    tool_quaternions_in_base: float64[T + 1, arms, 4], wxyz.
    """

    arms: tuple[str, ...]
    ticks: NDArray[np.int64]
    observations: Mapping[str, NDArray[np.float64]]
    actions: NDArray[np.float64]
    sources: NDArray[np.int8]
    engaged: NDArray[np.bool_]
    held: NDArray[np.bool_]
    holders: NDArray[np.int16]
    holder_names: tuple[str, ...]
    subtasks: Mapping[str, NDArray[np.bool_]]
    success: NDArray[np.bool_]
    sim_time_s: NDArray[np.float64]
    sent_ns: NDArray[np.int64]
    integration_states: NDArray[np.float64]
    tool_positions_in_base: NDArray[np.float64]
    tool_quaternions_in_base: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.actions)

    def rows(self, states: Rows, moves: Rows) -> EpisodeData:
        """Return these rows: K + 1 of what is of states, K of what is of the transitions between them.

        A slice gives the same memory, numbers of rows (int64) a copy.
        """
        return replace(
            self,
            ticks=self.ticks[states],
            observations={name: values[states] for name, values in self.observations.items()},
            actions=self.actions[moves],
            sources=self.sources[moves],
            engaged=self.engaged[moves],
            held=self.held[moves],
            holders=self.holders[moves],
            subtasks={name: done[states] for name, done in self.subtasks.items()},
            success=self.success[states],
            sim_time_s=self.sim_time_s[states],
            sent_ns=self.sent_ns[states],
            integration_states=self.integration_states[states],
            tool_positions_in_base=self.tool_positions_in_base[states],
            tool_quaternions_in_base=self.tool_quaternions_in_base[states],
        )
