"""Lay an episode's numbers out as LeRobot's columns, one row a frame, and say what each is.

The arms' own observations are `observation.state`, all others `observation.environment_state`, in the catalogue's
order; quaternions stay wxyz.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.tasks import Observation, Task
from mart.recorder.export.holders import holder_column

Columns = dict[str, NDArray[Any]]  # by feature, one row a frame


def columns_of(data: EpisodeData, task: Task, control_hz: float, holders: Sequence[str]) -> Columns:
    """Return the columns of one episode, as the first of its data set. holders: whom the data set numbers."""
    count = len(data)
    frame = np.arange(count)
    seen = {
        part: np.concatenate(
            [data.observations[one.name][:-1].reshape(count, -1) for one in observations], axis=1
        ).astype(np.float32)
        for part, observations in observation_parts(task).items()
    }
    return {
        **seen,
        "action": data.actions.reshape(count, -1).astype(np.float32),
        "source": data.sources.astype(np.int64),
        "engaged": data.engaged,
        "held": data.held,
        "holder": holder_column(data, holders),
        "recorded_tick": data.ticks[:-1],
        "next.reward": data.success[1:].astype(np.float32),
        "next.success": data.success[1:],
        "next.done": frame == count - 1,
        "timestamp": (frame / control_hz).astype(np.float32),
        "frame_index": frame,
        "episode_index": np.zeros(count, dtype=np.int64),
        "index": frame,
        "task_index": np.zeros(count, dtype=np.int64),
    }


def observation_parts(task: Task) -> dict[str, list[Observation]]:
    """Return by feature which observations are in it, in order."""
    own = [one for one in task.observations if one.name.partition("/")[0] in task.arm_names]
    rest = [one for one in task.observations if one not in own]
    return {"observation.state": own} | ({"observation.environment_state": rest} if rest else {})


def feature_of(name: str, values: NDArray[Any], task: Task) -> dict[str, Any]:
    """Describe a column as `meta/info.json` does: its type, shape, and each number's name."""
    names: list[str] | None = None
    if name == "action":
        names = [f"{arm}/action/{i}" for arm in task.arm_names for i in range(ACTION_SIZE)]
    elif name in ("source", "engaged", "held", "holder"):
        names = [f"{arm}/{name}" for arm in task.arm_names]
    for part, observations in observation_parts(task).items():
        if part == name:
            names = [f"{one.name}/{i}" for one in observations for i in range(int(np.prod(one.shape)))]
    return {"dtype": values.dtype.name, "shape": [*values.shape[1:]] or [1], "names": names}


def arrow_column(values: NDArray[Any]) -> pa.Array:
    """Return a column of Parquet; one number a row is a plain one, as LeRobot has it."""
    flat = pa.array(values.ravel())
    return (
        flat
        if values.ndim == 1 or values.shape[1] == 1
        else pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
    )
