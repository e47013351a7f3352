"""One episode as transitions: what was seen, what was done then, what came of it (docs/protocol.md, section 3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import State
from mart.protocol.recording import STATE
from mart.protocol.tasks import Observation, Task


@dataclass(frozen=True)
class Transitions:
    """T of them. Row t is the state before action t; what is seen has one row more, after the last action.

    observations: by the catalogue's names, each float64[T + 1, *shape]; quaternions wxyz.
    states: float64[T + 1, size], MuJoCo's integration states.
    actions: float64[T, arms, 7], as applied, in [-1, 1]; the arms in the task's order.
    success: bool[T], whether the task was done after the action.
    """

    observations: Mapping[str, NDArray[np.float64]]
    states: NDArray[np.float64]
    actions: NDArray[np.float64]
    success: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.actions)


def read_transitions(file: EpisodeFile, task: Task) -> Transitions:
    """Raises Corrupt where the file is damaged and InvalidInput, naming it, where it is not whole or not finite."""
    states = [codec.decode(State, message.payload) for message in file.messages(STATE)]
    try:
        return from_states(states, task)
    except InvalidInput as error:
        raise InvalidInput(f"{file.path} cannot be exported: {error}") from error


def from_states(states: Sequence[State], task: Task) -> Transitions:
    """The states of one episode, the one after the reset first."""
    if len(states) < 2:
        raise InvalidInput(f"it has {len(states)} states, and at least 2 are needed.")
    for before, after in pairwise(states):
        if after.episode_tick != before.episode_tick + 1:
            raise InvalidInput(
                f"ticks are missing after tick {before.episode_tick}; every one must be there."
            )
    actions = np.array([_actions(state, task) for state in states[1:]])
    if not (np.abs(actions) <= 1.0).all():  # false for NaN too
        raise InvalidInput("an action is NaN or outside -1 … 1.")
    seen = [{one.name: one.value for one in state.observations} for state in states]
    return Transitions(
        observations={wanted.name: _observed(wanted, seen) for wanted in task.observations},
        states=_integration_states(states),
        actions=actions,
        success=np.array([state.progress.success for state in states[1:]]),
    )


def _actions(state: State, task: Task) -> list[Sequence[float]]:
    """[arms, 7]."""
    arms = {arm.arm: arm.action for arm in state.arms}
    missing = [name for name in task.arm_names if len(arms.get(name, ())) != ACTION_SIZE]
    if missing:
        raise InvalidInput(
            f"{missing[0]} has no action at tick {state.episode_tick}; every arm must have one."
        )
    return [arms[name] for name in task.arm_names]


def _observed(wanted: Observation, seen: Sequence[Mapping[str, Sequence[float]]]) -> NDArray[np.float64]:
    """[states, *shape]."""
    size = int(np.prod(wanted.shape))
    if any(len(state.get(wanted.name, ())) != size for state in seen):
        raise InvalidInput(f"the observation {wanted.name} of {size} numbers is not in every state.")
    values = np.array([state[wanted.name] for state in seen])
    if not np.isfinite(values).all():
        raise InvalidInput(
            f"the observation {wanted.name} holds NaN or infinity; every number must be finite."
        )
    return values.reshape(-1, *wanted.shape)


def _integration_states(states: Sequence[State]) -> NDArray[np.float64]:
    sizes = {len(state.integration_state) for state in states}
    if len(sizes) != 1 or sizes.pop() % 8:
        raise InvalidInput("its integration states are not all of one size.")
    return np.stack([np.frombuffer(state.integration_state, "<f8") for state in states])
