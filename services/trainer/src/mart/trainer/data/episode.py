"""Read one episode as arrays of what a model takes.

A tick's state carries the action that led to it, so a transition is: observation of state t, action in state t + 1,
observation of state t + 1 (docs/protocol.md, section 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData, arrays_from_states
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.messages import State
from mart.protocol.tasks import Task
from mart.trainer.data.layout import ObservationLayout


@dataclass(frozen=True)
class EpisodeArrays:
    """Hold T transitions of an episode, or of a segment of one, T + 1 observations.

    observations: float32[T + 1, layout.width].
    actions: float32[T, arms, 7], what was applied in the tick after each observation but the last.
    sources: int8[T, arms], who drove the arm in that tick (mart.v1.Operator).
    """

    observations: NDArray[np.float32]
    actions: NDArray[np.float32]
    sources: NDArray[np.int8]


def read_episode(
    episode: LabelledEpisode,
    task: Task,
    layout: ObservationLayout,
    control_hz: float | None = None,
    skip_idle_s: float | None = None,
) -> list[EpisodeArrays]:
    """Read the segments of an episode of a task, as people edited it (`LabelledEpisode.segments`).

    Raises Corrupt where the file is damaged and InvalidInput, naming it, where it is not whole or has no such rate.
    """
    segments = episode.segments(task, control_hz, skip_idle_s, with_integration_states=False)
    return [from_data(layout, segment) for segment in segments]


def from_states(layout: ObservationLayout, states: Sequence[State]) -> EpisodeArrays:
    """Turn the states of one episode in their order, the one after the reset first, into arrays."""
    shapes = {field.name: field.shape for field in layout.fields}
    return from_data(layout, arrays_from_states(states, layout.arms, shapes, with_integration_states=False))


def from_data(layout: ObservationLayout, data: EpisodeData) -> EpisodeArrays:
    """Turn the arrays of one episode into what a model takes."""
    return EpisodeArrays(
        observations=layout.vector(data.observations),
        actions=data.actions.astype(np.float32),
        sources=data.sources,
    )
