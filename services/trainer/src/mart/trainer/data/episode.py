"""One episode as arrays, read from its file.

A tick's state carries the action that led to it, so a transition is: observation of state t, action in state t + 1,
observation of state t + 1 (docs/protocol.md, section 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import ArmState, State
from mart.protocol.recording import STATE
from mart.trainer.data.layout import ObservationLayout


@dataclass(frozen=True)
class EpisodeArrays:
    """T transitions of an episode, T + 1 observations.

    observations: float32[T + 1, layout.width].
    actions: float32[T, arms, 7], what was applied in the tick after each observation but the last.
    sources: int8[T, arms], who drove the arm in that tick (mart.v1.Operator).
    """

    observations: NDArray[np.float32]
    actions: NDArray[np.float32]
    sources: NDArray[np.int8]


def read_episode(file: EpisodeFile, layout: ObservationLayout) -> EpisodeArrays:
    """Raises Corrupt where the file is damaged and InvalidInput, naming it, where it cannot be learned from."""
    try:
        return from_states(layout, [codec.decode(State, one.payload) for one in file.messages(STATE)])
    except InvalidInput as error:
        raise InvalidInput(f"{file.path} cannot be learned from: {error}") from error


def from_states(layout: ObservationLayout, states: Sequence[State]) -> EpisodeArrays:
    """The states of one episode in their order, the one after the reset first."""
    if len(states) < 2:
        raise InvalidInput(f"it has {len(states)} states, and at least 2 are needed.")
    steps = np.diff([state.episode_tick for state in states])
    if (steps != 1).any():
        tick = states[int((steps != 1).argmax())].episode_tick
        raise InvalidInput(f"ticks are missing after tick {tick}; every one must be there.")
    moved = [_arms(layout, state) for state in states[1:]]
    return EpisodeArrays(
        observations=layout.vector(_observations(layout, states)),
        actions=_actions(moved),
        sources=np.array([[arm.source for arm in arms] for arms in moved], dtype=np.int8),
    )


def _observations(layout: ObservationLayout, states: Sequence[State]) -> dict[str, NDArray[np.float64]]:
    """By name, each [states, *shape]."""
    named = [{seen.name: seen.value for seen in state.observations} for state in states]
    missing = [field.name for field in layout.fields if any(field.name not in state for state in named)]
    if missing:
        raise InvalidInput(f"the observation {missing[0]} is missing; it must be in every state.")
    try:
        return {
            field.name: np.array([state[field.name] for state in named]).reshape(-1, *field.shape)
            for field in layout.fields
        }
    except ValueError as error:
        raise InvalidInput("an observation has another shape than the task catalogue says.") from error


def _arms(layout: ObservationLayout, state: State) -> list[ArmState]:
    """In the task's order."""
    arms = {arm.arm: arm for arm in state.arms}
    if tuple(sorted(arms)) != tuple(sorted(layout.arms)):
        raise InvalidInput(
            f"tick {state.episode_tick} has the arms {', '.join(sorted(arms)) or 'none'}; "
            f"all of {', '.join(layout.arms)} must be there."
        )
    return [arms[name] for name in layout.arms]


def _actions(moved: Sequence[Sequence[ArmState]]) -> NDArray[np.float32]:
    """[ticks, arms, 7]."""
    if any(len(arm.action) != ACTION_SIZE for arms in moved for arm in arms):
        raise InvalidInput(f"an arm has no action of {ACTION_SIZE} numbers after the first state.")
    actions = np.array([[arm.action for arm in arms] for arms in moved], dtype=np.float32)
    if not np.isfinite(actions).all():
        raise InvalidInput("an action holds NaN or infinity; every number must be finite.")
    return actions
