"""Tell in which ticks a hand was not known: a phone had lost its tracking, or was somewhere else at once. Pure."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mart.protocol.messages import HAND_FAULT_UNSPECIFIED, Command


class HandFaults:
    """Gather the commands of one episode, of which only the faults are kept."""

    def __init__(self) -> None:
        self._ticks: dict[str, array[int]] = {}

    def add(self, command: Command) -> None:
        """Take one command, of any arm; what it does not tell is no fault."""
        if command.hand_fault != HAND_FAULT_UNSPECIFIED and command.state_tick:
            ticks = self._ticks.setdefault(command.arm, array("Q"))
            if not ticks or ticks[-1] != command.state_tick:
                ticks.append(command.state_tick)

    def transitions(self, arms: Sequence[str], first_tick: int, count: int) -> NDArray[np.bool_]:
        """Return bool[count, arms]: whether the hand was not known in the transition from state t to state t + 1.

        first_tick: of the room, at the episode's first state.
        """
        found = np.zeros((count, len(arms)), np.bool_)
        for column, arm in enumerate(arms):
            ticks = np.array(self._ticks.get(arm, ()), np.int64) - first_tick
            found[ticks[(ticks >= 0) & (ticks < count)], column] = True
        return found
