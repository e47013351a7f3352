"""Hold one episode of another project's data set, as numbers, and what is said of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_ROWS = 400_000  # of an episode: an hour at 100 a second
MAX_EPISODES = 100_000  # of a data set
MAX_WIDTH = 4096  # numbers of one observation or action: pictures have more
MAX_EPISODE_BYTES = 512 * 1024 * 1024  # of all numbers of one episode, as float64
MAX_MODEL_BYTES = 128 * 1024 * 1024


@dataclass(frozen=True)
class Setting:
    """Say of what a data set is. task: a name of the catalogue, where it names one; control_hz: None where unknown."""

    task: str | None = None
    arms: int | None = None
    arm_kinds: tuple[str, ...] = ()
    control_hz: float | None = None


@dataclass(frozen=True)
class OriginRows:
    """Hold what MART's own exports carry besides (`export.origins`), a row for each of T + 1 states.

    records: the metadata records of the episode that was exported, by name, as strings.
    last_observations: by key, what was seen after the last action. mjb: the compiled model, None where it is not there.
    """

    records: Mapping[str, Mapping[str, str]]
    outcome: str
    sim_time_s: Array
    sent_ns: NDArray[np.int64]
    success: NDArray[np.bool_]
    tool_positions_in_base: Array
    tool_quaternions_in_base: Array
    last_tick: int
    subtasks: Mapping[str, NDArray[np.bool_]]
    last_observations: Mapping[str, Array]
    last_state: Array | None = None
    mjb: bytes | None = None
    task_file: bytes | None = None


@dataclass(frozen=True)
class ForeignEpisode:
    """Hold one episode: T rows, each seen before the action of the same row.

    name: of the demonstration in its data set. source_sha256: of the file it was in.
    observations: by key, float64[T, width]; last: the same after the last action, None where that was not written.
    actions: float64[T, width]. sources, engaged, ticks: as MART's exports have them, None where there are none.
    states: MuJoCo's integration states, float64[T, size]. success: bool[T], after each action.
    left_out: what of it is not taken, in words.
    """

    name: str
    number: int
    source_file: str
    source_sha256: str
    observations: Mapping[str, Array]
    actions: Array
    last: Mapping[str, Array] | None = None
    success: NDArray[np.bool_] | None = None
    sources: NDArray[np.int64] | None = None
    engaged: NDArray[np.bool_] | None = None
    ticks: NDArray[np.int64] | None = None
    states: Array | None = None
    outcome: str = ""
    operators: Mapping[str, str] = field(default_factory=dict)
    instruction: str = ""
    left_out: tuple[str, ...] = ()
    origin: OriginRows | None = None

    def __len__(self) -> int:
        return len(self.actions)


@dataclass(frozen=True)
class NotImported:
    """Say which demonstration was not imported, and why."""

    name: str
    why: str
